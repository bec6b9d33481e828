/* SPDX-License-Identifier: MIT */
#include "device/queue.h"

/* Stands for a buffer that is only counted: some commands depend on whether there is one. */
static cl_mem count(sv_tally *tally, size_t bytes) {
    tally->bytes += bytes;
    if (bytes > tally->largest) tally->largest = bytes;
    return (cl_mem)(void *)tally;
}

static cl_mem create(const sv_queue *queue, cl_mem_flags flags, size_t bytes, void *memory,
                     sv_status *status) {
    cl_int code = CL_SUCCESS;
    const cl_mem buffer = clCreateBuffer(queue->device->context, flags, bytes, memory, &code);
    if (code == CL_SUCCESS) return buffer;
    *status = sva_error(queue->diag, SV_ERR_OPENCL, "clCreateBuffer of %zu bytes: %s (%d)", bytes,
                        sva_cl_name(code), code);
    return NULL;
}

sv_status sv_buffer_clear(const sv_queue *queue, cl_mem buffer, size_t bytes) {
    const cl_uchar zero = 0;
    return sva_cl_check(queue->diag,
                        clEnqueueFillBuffer(queue->device->queue, buffer, &zero, 1, 0, bytes, 0, NULL, NULL),
                        "clEnqueueFillBuffer");
}

cl_mem sv_buffer_make(const sv_queue *queue, size_t bytes, sv_status *status) {
    if (*status != SV_OK) return NULL;
    if (bytes == 0) bytes = 1;
    if (queue->tally) return count(queue->tally, bytes);
    const cl_mem buffer = create(queue, CL_MEM_READ_WRITE, bytes, NULL, status);
    if (!buffer) return NULL;
    *status = sv_buffer_clear(queue, buffer, bytes);
    return buffer;
}

sv_status sv_buffers_make(const sv_queue *queue, const size_t *bytes, size_t count, cl_mem *buffers) {
    sv_status status = SV_OK;
    for (size_t i = 0; i < count; i++) buffers[i] = sv_buffer_make(queue, bytes[i], &status);
    return status;
}

sv_status sv_buffer_read(const sv_queue *queue, cl_mem buffer, size_t bytes, void *out, const char *what) {
    return sva_cl_check(
        queue->diag, clEnqueueReadBuffer(queue->device->queue, buffer, CL_TRUE, 0, bytes, out, 0, NULL, NULL),
        what);
}

cl_mem sv_buffer_wrap(const sv_queue *queue, const void *memory, size_t bytes, sv_status *status) {
    if (*status != SV_OK) return NULL;
    if (queue->tally) return count(queue->tally, 0);
    return create(queue, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes, (void *)(uintptr_t)memory, status);
}

void sv_buffer_release(cl_mem *buffer) {
    if (*buffer) (void)clReleaseMemObject(*buffer);
    *buffer = NULL;
}

sv_launch sv_launch_begin(const sv_queue *queue, cl_kernel kernel, const char *name) {
    return (sv_launch){.queue = queue, .kernel = kernel, .name = name};
}

sv_launch sv_launch_job(const sv_queue *queue, cl_kernel kernel, const char *name, const sv_job *job) {
    sv_launch l = sv_launch_begin(queue, kernel, name);
    sv_launch_arg(&l, sizeof *job, job);
    return l;
}

void sv_launch_arg(sv_launch *launch, size_t bytes, const void *value) {
    if (launch->code == CL_SUCCESS && !launch->queue->tally)
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
    if (sv_counted(q)) return SV_OK;
    if (l->code == CL_SUCCESS)
        l->code = clEnqueueNDRangeKernel(q->device->queue, l->kernel, dimensions, NULL, global, local, 0,
                                         NULL, sv_timing_slot(q->timing, stage));
    if (l->code == CL_SUCCESS) return SV_OK;
    return sva_error(q->diag, SV_ERR_OPENCL, "kernel %s, argument or launch: %s (%d)", l->name,
                     sva_cl_name(l->code), l->code);
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
