/* SPDX-License-Identifier: MIT */
#include "render/host_launch.h"

#include <stdio.h>

/* The same for volumes of all sizes, because PoCL compiles a kernel for every size of its groups. */
enum { ROWS_OF_GROUP = 8 };

hs_launch hs_launch_begin(const hs_cl *cl, cl_kernel kernel, const char *name) {
    return (hs_launch){.cl = cl, .kernel = kernel, .name = name, .code = CL_SUCCESS};
}

void hs_launch_arg(hs_launch *launch, size_t bytes, const void *value) {
    if (launch->code == CL_SUCCESS)
        launch->code = clSetKernelArg(launch->kernel, launch->next++, bytes, value);
}

void hs_launch_buffer(hs_launch *launch, cl_mem buffer) {
    hs_launch_arg(launch, sizeof buffer, buffer ? &buffer : NULL);
}

bool hs_launch_run(const hs_launch *launch, cl_uint dimensions, const size_t *global, const size_t *local,
                   cl_event *event, hs_error *err) {
    const char *call = "clSetKernelArg";
    cl_int code = launch->code;
    if (code == CL_SUCCESS) {
        call = "clEnqueueNDRangeKernel";
        code = clEnqueueNDRangeKernel(launch->cl->queue, launch->kernel, dimensions, NULL, global, local, 0,
                                      NULL, event);
    }
    char what[128];
    (void)snprintf(what, sizeof what, "%s(%s)", call, launch->name);
    return hs_cl_check(code, what, err);
}

bool hs_launch_items(const hs_launch *launch, cl_uint dimensions, const size_t *global, cl_event *event,
                     hs_error *err) {
    static const size_t one[3] = {1, 1, 1};
    return hs_launch_run(launch, dimensions, global, launch->cl->is_cpu ? one : NULL, event, err);
}

bool hs_launch_rows(const hs_launch *launch, cl_int4 dims, hs_error *err) {
    static const size_t group[3] = {1, ROWS_OF_GROUP, 1};
    const size_t x = (size_t)dims.s[0], y = (size_t)dims.s[1], z = (size_t)dims.s[2];
    const size_t rows[3] = {1, (y + ROWS_OF_GROUP - 1) / ROWS_OF_GROUP * ROWS_OF_GROUP, z};
    if (launch->cl->lanes == 1) return hs_launch_items(launch, 3, (const size_t[]){x, y, z}, NULL, err);
    return hs_launch_run(launch, 3, rows, group, NULL, err);
}

bool hs_launch_slices(const hs_launch *launch, cl_int4 dims, hs_error *err) {
    const size_t x = (size_t)dims.s[0], y = (size_t)dims.s[1], z = (size_t)dims.s[2];
    const bool slices = launch->cl->lanes > 1;
    return hs_launch_items(launch, 3, (const size_t[]){slices ? 1 : x, slices ? 1 : y, z}, NULL, err);
}
