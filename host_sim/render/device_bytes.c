/* SPDX-License-Identifier: MIT */
#include "render/device_bytes.h"

bool hs_device_bytes_init(hs_device_bytes *bytes, const hs_cl *cl, size_t count, bool wrapped,
                          hs_error *err) {
    *bytes = (hs_device_bytes){.cl = cl, .bytes = count};
    if (wrapped) return true;
    cl_int code = CL_SUCCESS;
    bytes->copy = clCreateBuffer(cl->context, CL_MEM_READ_ONLY, count + 1, NULL, &code);
    return hs_cl_check(code, "clCreateBuffer(volume)", err);
}

/* The buffer around this host memory: a known one, or a new one in the place of the oldest. */
static bool wrap(hs_device_bytes *b, const uint8_t *host, hs_error *err) {
    for (uint32_t i = 0; i < HS_WRAP_COUNT; i++) {
        if (b->wrap[i].host != host) continue;
        b->buffer = b->wrap[i].buffer;
        /* The contents may be new: OpenCL wants to be told before a command reads them. */
        cl_int code = CL_SUCCESS;
        void *mapped = clEnqueueMapBuffer(b->cl->queue, b->buffer, CL_FALSE, CL_MAP_WRITE_INVALIDATE_REGION,
                                          0, b->bytes, 0, NULL, NULL, &code);
        if (!hs_cl_check(code, "clEnqueueMapBuffer(volume)", err)) return false;
        code = clEnqueueUnmapMemObject(b->cl->queue, b->buffer, mapped, 0, NULL, NULL);
        return hs_cl_check(code, "clEnqueueUnmapMemObject(volume)", err);
    }
    union {
        const uint8_t *in;
        void *out;
    } pointer = {host}; /* read-only for the device, whatever the prototype says */
    cl_int code = CL_SUCCESS;
    cl_mem buffer =
        clCreateBuffer(b->cl->context, CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, b->bytes, pointer.out, &code);
    if (!hs_cl_check(code, "clCreateBuffer(volume in host memory)", err)) return false;
    uint32_t slot = b->wrap_next;
    if (b->wrap[slot].buffer) (void)clReleaseMemObject(b->wrap[slot].buffer);
    b->wrap[slot].host = host;
    b->wrap[slot].buffer = buffer;
    b->wrap_next = (slot + 1) % HS_WRAP_COUNT;
    b->buffer = buffer;
    return true;
}

bool hs_device_bytes_bring(hs_device_bytes *b, const uint8_t *host, hs_error *err) {
    if (!b->copy) return wrap(b, host, err);
    b->buffer = b->copy;
    return hs_cl_check(
        clEnqueueWriteBuffer(b->cl->queue, b->copy, CL_FALSE, 0, b->bytes, host, 0, NULL, NULL),
        "clEnqueueWriteBuffer(volume)", err);
}

void hs_device_bytes_free(hs_device_bytes *b) {
    if (b->copy) (void)clReleaseMemObject(b->copy);
    for (uint32_t i = 0; i < HS_WRAP_COUNT; i++)
        if (b->wrap[i].buffer) (void)clReleaseMemObject(b->wrap[i].buffer);
    *b = (hs_device_bytes){0};
}
