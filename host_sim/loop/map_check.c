/* SPDX-License-Identifier: MIT */
#include "loop/map_check.h"

bool hs_map_check_create(hs_map_check *check, const hs_cl *cl, uint32_t width, uint32_t rows, hs_error *err) {
    *check = (hs_map_check){.cl = cl, .width = width, .rows = rows};
    return hs_cl_take_buffer(cl, sizeof check->count, "map check", &check->wrong, err) &&
           hs_cl_take_kernel(cl, "check_map", &check->kernel, err);
}

void hs_map_check_destroy(hs_map_check *check) {
    if (check->kernel) clReleaseKernel(check->kernel);
    if (check->wrong) clReleaseMemObject(check->wrong);
    *check = (hs_map_check){0};
}

bool hs_map_check_enqueue(hs_map_check *check, cl_mem map, float low, float high, hs_error *err) {
    static const cl_int none = 0;
    const cl_command_queue queue = check->cl->queue;
    const cl_int width = (cl_int)check->width;
    cl_int code = clEnqueueFillBuffer(queue, check->wrong, &none, sizeof none, 0, sizeof none, 0, NULL, NULL);
    if (!hs_cl_check(code, "clEnqueueFillBuffer (map check)", err)) return false;
    hs_launch launch = hs_launch_begin(check->cl, check->kernel, "check_map");
    hs_launch_buffer(&launch, map);
    hs_launch_arg(&launch, sizeof width, &width);
    hs_launch_arg(&launch, sizeof low, &low);
    hs_launch_arg(&launch, sizeof high, &high);
    hs_launch_buffer(&launch, check->wrong);
    if (!hs_launch_items(&launch, 1, &check->rows, NULL, err)) return false;
    code = clEnqueueReadBuffer(queue, check->wrong, CL_FALSE, 0, sizeof check->count, &check->count, 0, NULL,
                               NULL);
    return hs_cl_check(code, "clEnqueueReadBuffer (map check)", err);
}
