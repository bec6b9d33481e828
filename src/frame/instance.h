/* SPDX-License-Identifier: MIT */
/* What activate makes. The ABI's states and values are smartvis/author.h's. */
#pragma once

#include "frame/pipeline.h"
#include "smartvis/needs.h"

#include <sys/types.h>

typedef struct {
    sv_diag *diag;
    pid_t process; /* that activated it: OpenCL does not live on in a fork's child */
    sv_device device;
    sv_builds builds; /* while it is being activated */
    sv_program narrow, wide;
    sv_timing timing;
    sv_pipeline pipeline;
} sv_instance;

/* Everything of activate once the format has been found valid. After a failure, too, sv_instance_deactivate
 * frees what was made. `values`: the defaults with what the format sets. */
sv_status sv_instance_activate(sv_instance *instance, const sv_format *format, const sv_values *values);
/* What that would take on such a device, and a frame with these values; without OpenCL and without a change.
 * `out` is as long as this header's. */
sv_status sv_instance_needs(sv_diag *diag, const sv_device *device, const sv_format *format,
                            const sv_values *activated, const sv_values *frame, sv_needs *out);
void sv_instance_deactivate(sv_instance *instance);

/* True in a process that was forked after activate: it has none of OpenCL's threads, and a call would hang.
 * check_process: then SV_ERR_STATE with what to do. */
bool sv_instance_is_forked(const sv_instance *instance);
sv_status sv_instance_check_process(const sv_instance *instance);
