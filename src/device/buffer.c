/* SPDX-License-Identifier: MIT */
#include "device/buffer.h"

static void count(sv_tally *tally, size_t bytes) {
    tally->bytes += bytes;
    if (bytes > tally->largest) tally->largest = bytes;
}

static cl_mem create(const sv_queue *queue, cl_mem_flags flags, size_t bytes, void *memory,
                     sv_status *status) {
    cl_int code = CL_SUCCESS;
    const cl_mem buffer = clCreateBuffer(queue->device->context, flags, bytes, memory, &code);
    if (code == CL_SUCCESS) return buffer;
    *status = sv_fail(queue->diag, SV_ERR_OPENCL, "clCreateBuffer of %zu bytes: %s (%d)", bytes,
                      sv_clx_name(code), code);
    return NULL;
}

cl_mem sv_buffer_make(const sv_queue *queue, size_t bytes, sv_status *status) {
    if (*status != SV_OK) return NULL;
    if (bytes == 0) bytes = 1;
    if (queue->tally) {
        count(queue->tally, bytes);
        return NULL;
    }
    const cl_mem buffer = create(queue, CL_MEM_READ_WRITE, bytes, NULL, status);
    if (!buffer) return NULL;
    const cl_uchar zero = 0;
    *status = sv_clx_check(
        queue->diag, clEnqueueFillBuffer(queue->device->queue, buffer, &zero, 1, 0, bytes, 0, NULL, NULL),
        "clEnqueueFillBuffer");
    return buffer;
}

sv_status sv_buffers_make(const sv_queue *queue, const size_t *bytes, size_t count, cl_mem *buffers) {
    sv_status status = SV_OK;
    for (size_t i = 0; i < count; i++) buffers[i] = sv_buffer_make(queue, bytes[i], &status);
    return status;
}

sv_status sv_buffer_read(const sv_queue *queue, cl_mem buffer, size_t bytes, void *out, const char *what) {
    return sv_clx_check(
        queue->diag, clEnqueueReadBuffer(queue->device->queue, buffer, CL_TRUE, 0, bytes, out, 0, NULL, NULL),
        what);
}

cl_mem sv_buffer_wrap(const sv_queue *queue, const void *memory, size_t bytes, sv_status *status) {
    if (*status != SV_OK || queue->tally) return NULL;
    return create(queue, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes, (void *)(uintptr_t)memory, status);
}

void sv_buffer_release(cl_mem *buffer) {
    if (*buffer) (void)clReleaseMemObject(*buffer);
    *buffer = NULL;
}
