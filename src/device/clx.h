/* SPDX-License-Identifier: MIT */
/* Checked OpenCL calls: the bottom layer. Every failure carries the call's name and the code's name. */
#ifndef SV_CLX_H
#define SV_CLX_H

#include "device/diag.h"

#include <CL/cl.h>
#include <stdbool.h>

/* Name of an OpenCL error code, "CL_INVALID_VALUE". */
const char *sv_clx_name(cl_int code);

/* SV_OK for CL_SUCCESS, else SV_ERR_OPENCL with "what: CL_..., -30". */
sv_status sv_clx_check(sv_diag *diag, cl_int code, const char *what);

/* The device the plugin works on. In own-queue mode context and queue are the plugin's and owned is true. */
typedef struct {
    cl_context context;
    cl_device_id device;
    cl_command_queue queue;
    bool owned;
    bool is_cpu;        /* a CPU: the strip kernels, and host memory read in place */
    bool shares_memory; /* CL_DEVICE_HOST_UNIFIED_MEMORY on a CPU */
    bool has_doubles;   /* cl_khr_fp64 */
    cl_uint compute_units;
} sv_device;

/* Uses the host's objects, or, if all are NULL, opens the first GPU, else the first device, with an in-order
 * profiling queue. The environment variable SMARTVIS_DEVICE ("cpu" or "gpu") narrows that choice. */
sv_status sv_device_open(sv_diag *diag, cl_context context, cl_device_id device, cl_command_queue queue,
                         sv_device *out);

/* Releases what sv_device_open made; leaves a host's objects alone. Safe on a zeroed struct. */
void sv_device_close(sv_device *device);

/* A buffer of at least one byte, zeroed by the queue (or, with host_ptr, wrapped around it). NULL on failure.
 */
cl_mem sv_clx_buffer(sv_diag *diag, const sv_device *device, size_t bytes, void *host_ptr, sv_status *status);

/* clReleaseMemObject that takes NULL, and nulls. */
void sv_clx_release(cl_mem *buffer);

#endif
