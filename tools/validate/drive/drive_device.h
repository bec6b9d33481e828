/* SPDX-License-Identifier: MIT */
/* The validator's OpenCL device: what a host hands to a plugin that works on the host's queue. */
#ifndef DRIVE_DEVICE_H
#define DRIVE_DEVICE_H

#include "validate/drive/drive_run.h"

#include <CL/cl.h>

typedef struct {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue; /* in-order */
} v_device;

/* The first GPU, else the first device of any kind; SMARTVIS_DEVICE ("cpu", "gpu") narrows the choice. Skips
 * the check if there is none. */
void v_device_open(v_run *run, v_device *d);
void v_device_close(v_device *d);

#endif
