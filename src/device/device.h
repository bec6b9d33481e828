/* SPDX-License-Identifier: MIT */
/* Which OpenCL device: the host's, or one that the plugin opens itself. */
#pragma once

#include "device/diag.h"

#include <stdbool.h>

typedef struct sv_builds sv_builds; /* device/program.h */

/* The device the plugin works on. In own-queue mode context and queue are the plugin's and owned is true. */
typedef struct {
    cl_context context;
    cl_device_id device;
    cl_command_queue queue;
    bool owned;
    bool is_cpu;        /* a CPU: the strip kernels, and host memory read in place */
    bool rays_only;     /* rusticl: a work item has one ray, as on a GPU, whatever the device is */
    bool shares_memory; /* CL_DEVICE_HOST_UNIFIED_MEMORY on a CPU */
    bool has_doubles;   /* cl_khr_fp64 */
    cl_uint compute_units;
    cl_ulong memory;         /* CL_DEVICE_GLOBAL_MEM_SIZE, bytes */
    cl_ulong largest_buffer; /* CL_DEVICE_MAX_MEM_ALLOC_SIZE, bytes */
    sv_builds *builds;       /* what was compiled for it so far, or NULL: nothing is kept */
} sv_device;

/* Uses the host's objects, or, if all are NULL, opens the first device of smartvis/device.h that works, with
 * an in-order profiling queue. */
sv_status sv_device_open(sv_diag *diag, cl_context context, cl_device_id device, cl_command_queue queue,
                         sv_device *out);

/* Releases what sv_device_open made; leaves a host's objects alone. Safe on a zeroed struct. */
void sv_device_close(sv_device *device);
