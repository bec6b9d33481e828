/* SPDX-License-Identifier: MIT */
/* One plugin instance: what activate makes, and the state machine of the ABI. */
#ifndef SV_INSTANCE_H
#define SV_INSTANCE_H

#include "frame/pipeline.h"

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
    sv_program narrow, wide;
    sv_timing timing;
    sv_pipeline pipeline;
    sv_values activated; /* defaults with the values activate was given */
    sv_values frame;     /* values of the frame under way, or of the last one */
} sv_instance;

/* Everything of activate once the format has been found valid; all or nothing. */
sv_status sv_instance_activate(sv_instance *instance, const sv_format *format);
void sv_instance_deactivate(sv_instance *instance);

/* The instance behind the ABI's table, at the start of a [control] or [frame] call: its last error is
 * forgotten. */
sv_instance *sv_instance_enter(const sv_plugin *plugin);

/* Validation at the ABI's edge: SV_OK, or an error that names the field and its value. */
sv_status sv_validate_format(sv_diag *diag, const sv_format *format);
sv_status sv_validate_frame(sv_diag *diag, const sv_pipeline *pipeline, const sv_frame *frame);
/* Values that do not go together, in a frame of this pipeline. */
sv_status sv_validate_values(sv_diag *diag, const sv_pipeline *pipeline, const sv_values *values);
sv_status sv_validate_slab(sv_diag *diag, const sv_pipeline *pipeline, const sv_slab *slab);
sv_status sv_validate_result(sv_diag *diag, const char *call, const sv_pipeline *pipeline,
                             const sv_result *result);

#endif
