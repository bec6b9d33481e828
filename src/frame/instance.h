/* SPDX-License-Identifier: MIT */
/* One plugin instance: what activate makes, and the state machine of the ABI. */
#ifndef SV_INSTANCE_H
#define SV_INSTANCE_H

#include "frame/pipeline.h"
#include "smartvis/needs.h"

typedef enum {
    SV_STATE_INACTIVE,
    SV_STATE_IDLE,    /* active, no volume yet, or the last frame failed */
    SV_STATE_SLABS,   /* begin was called */
    SV_STATE_FINISHED /* end succeeded: adjust is allowed */
} sv_state;

typedef struct {
    sv_plugin abi; /* first: the table that the host holds */
    sv_diag diag;
    sv_state state;
    sv_device device;
    sv_builds builds; /* while it is being activated */
    sv_program narrow, wide;
    sv_timing timing;
    sv_pipeline pipeline;
    sv_values activated; /* defaults with the values activate was given */
    sv_values frame;     /* values of the frame under way, or of the last one */
} sv_instance;

/* The instance behind the ABI's table, at the start of a [control] or [frame] call: its last
 * error is forgotten. */
sv_instance *sv_instance_enter(const sv_plugin *plugin);

/* Everything of activate once the format has been found valid; all or nothing. `values`: the defaults with
 * what the format sets. */
sv_status sv_instance_activate(sv_instance *instance, const sv_format *format, const sv_values *values);
/* What that would take on such a device, and a frame with these values; without OpenCL and without a change.
 * `out` is as long as this header's. */
sv_status sv_instance_needs(sv_diag *diag, const sv_device *device, const sv_format *format,
                            const sv_values *activated, const sv_values *frame, sv_needs *out);
void sv_instance_deactivate(sv_instance *instance);

#endif
