/* SPDX-License-Identifier: MIT */
/* Setting a kernel's arguments and launching it, with the first error kept. */
#ifndef HS_HOST_LAUNCH_H
#define HS_HOST_LAUNCH_H

#include "render/host_cl.h"

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

/* The same, on a CPU one work item a slice. */
bool hs_launch_slices(const hs_launch *launch, cl_int4 dims, hs_error *err);

#endif
