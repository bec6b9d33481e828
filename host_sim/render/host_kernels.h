/* SPDX-License-Identifier: MIT */
/* The machine's own kernels on its device: built, launched, and given memory. */
#pragma once

#include "opencl/host_cl.h"

/* hs_cl_open_bare, and builds the embedded kernels for the device. HS_ERR_DEVICE also where they do not
 * build, with the first lines of the build log. */
bool hs_cl_open(hs_cl *cl, hs_error *err);

/* The same with `lanes` 1 or 16 whatever the device: a CPU can run, and test, the kernels of a GPU. 0: as
 * fits. */
bool hs_cl_open_lanes(hs_cl *cl, uint32_t lanes, hs_error *err);

/* Make *kernel of the host's program, or *buffer of `bytes` bytes for kernels to read and write, unless it is
 * there. HS_ERR_DEVICE with the kernel's name, or with what the buffer holds. The caller releases it. */
bool hs_cl_take_kernel(const hs_cl *cl, const char *name, cl_kernel *kernel, hs_error *err);
bool hs_cl_take_buffer(const hs_cl *cl, size_t bytes, const char *what, cl_mem *buffer, hs_error *err);

/* The same for dims.xyz voxels of a byte. Trilinear lookups read a byte behind the last one
 * (cl/base_rays.cl), so there is one more. */
bool hs_cl_take_voxels(const hs_cl *cl, cl_int4 dims, const char *what, cl_mem *buffer, hs_error *err);

/* True if `buffer` holds at least `bytes` bytes; else records HS_ERR_DEVICE with `what` and both sizes. */
bool hs_cl_check_size(cl_mem buffer, uint64_t bytes, const char *what, hs_error *err);

/* Between begin and run. Arguments are set in their order; the first call that fails is remembered, and later
 * calls do nothing. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    const char *name; /* the kernel's, for error messages */
    cl_uint next;     /* index of the next argument */
    cl_int code;      /* of the first call that failed, else CL_SUCCESS */
} hs_launch;

/* `name` must stay valid until hs_launch_run. */
hs_launch hs_launch_begin(const hs_cl *cl, cl_kernel kernel, const char *name);

/* Sets the next argument from the `bytes` bytes at `value`. */
void hs_launch_arg(hs_launch *launch, size_t bytes, const void *value);

/* Sets the next argument to a buffer; NULL gives the kernel a null pointer. */
void hs_launch_buffer(hs_launch *launch, cl_mem buffer);

/* Enqueues the kernel over `dimensions` sizes; does not wait. `local` NULL lets OpenCL choose. `event`
 * (may be NULL) receives the command's event. False with HS_ERR_DEVICE, which names the call that
 * failed first and the kernel. */
bool hs_launch_run(const hs_launch *launch, cl_uint dimensions, const size_t *global, const size_t *local,
                   cl_event *event, hs_error *err);

/* The same for a kernel that may run in groups of any size. On a CPU, whatever its lanes, a group is one
 * item, so that PoCL compiles the kernel once and not for every size of group; else OpenCL chooses. */
bool hs_launch_items(const hs_launch *launch, cl_uint dimensions, const size_t *global, cl_event *event,
                     hs_error *err);

/* Enqueues a kernel that makes a volume of dims.xyz voxels: on a CPU one work item a row, and a work group of
 * eight rows, so that all cores get some and few enough are started; there may be more items than rows, and
 * the kernel leaves those alone. Else one work item a voxel. Otherwise as hs_launch_run. */
bool hs_launch_rows(const hs_launch *launch, cl_int4 dims, hs_error *err);

/* hs_launch_rows with, on a CPU, one work item a slice. */
bool hs_launch_slices(const hs_launch *launch, cl_int4 dims, hs_error *err);
