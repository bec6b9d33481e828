/* SPDX-License-Identifier: MIT */
#include "device/launch.h"

sv_launch sv_launch_begin(const sv_queue *queue, cl_kernel kernel, const char *name) {
    return (sv_launch){.queue = queue, .kernel = kernel, .name = name};
}

sv_launch sv_launch_job(const sv_queue *queue, cl_kernel kernel, const char *name, const sv_job *job) {
    sv_launch l = sv_launch_begin(queue, kernel, name);
    sv_launch_arg(&l, sizeof *job, job);
    return l;
}

void sv_launch_arg(sv_launch *launch, size_t bytes, const void *value) {
    if (launch->code == CL_SUCCESS)
        launch->code = clSetKernelArg(launch->kernel, launch->next++, bytes, value);
}

void sv_launch_buffer(sv_launch *launch, cl_mem buffer) {
    sv_launch_arg(launch, sizeof buffer, &buffer);
}

void sv_launch_uint(sv_launch *launch, uint32_t value) {
    sv_launch_arg(launch, sizeof value, &value);
}

static sv_status launch(sv_launch *l, cl_uint dimensions, const size_t *global, const size_t *local,
                        sv_stage stage) {
    const sv_queue *q = l->queue;
    if (l->code == CL_SUCCESS)
        l->code = clEnqueueNDRangeKernel(q->device->queue, l->kernel, dimensions, NULL, global, local, 0,
                                         NULL, sv_timing_slot(q->timing, stage));
    if (l->code == CL_SUCCESS) return SV_OK;
    return sv_fail(q->diag, SV_ERR_OPENCL, "kernel %s, argument or launch: %s (%d)", l->name,
                   sv_clx_name(l->code), l->code);
}

sv_status sv_launch_items(sv_launch *l, size_t items, sv_stage stage) {
    const size_t local = 1;
    return launch(l, 1, &items, &local, stage);
}

sv_status sv_launch_pixels(sv_launch *l, uint32_t width, uint32_t height, sv_stage stage) {
    const size_t local[2] = {SV_RAYS_LOCAL, 1};
    const size_t global[2] = {((size_t)width + SV_RAYS_LOCAL - 1) / SV_RAYS_LOCAL * SV_RAYS_LOCAL, height};
    return launch(l, 2, global, local, stage);
}

sv_status sv_launch_groups(sv_launch *l, size_t groups, sv_stage stage) {
    const size_t local = SV_GROUP_ITEMS, global = groups * SV_GROUP_ITEMS;
    return launch(l, 1, &global, &local, stage);
}

sv_status sv_launch_grid(sv_launch *l, size_t items_x, size_t items_y, sv_stage stage) {
    const size_t local[2] = {1, 1};
    const size_t global[2] = {items_x, items_y};
    return launch(l, 2, global, local, stage);
}

sv_status sv_launch_vectors(sv_launch *l, uint32_t padded_width, uint32_t height, sv_stage stage) {
    return sv_launch_grid(l, padded_width / SV_LANES, height, stage);
}
