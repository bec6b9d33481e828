/* SPDX-License-Identifier: MIT */
/* Bytes of the host on the device: read where they are by a CPU, copied for any other. */
#ifndef HS_DEVICE_BYTES_H
#define HS_DEVICE_BYTES_H

#include "render/host_cl.h"

#include <stddef.h>
#include <stdint.h>

#define HS_WRAP_COUNT 8 /* host buffers of a live sequence whose wrapping is remembered */

/* Zeroed: nothing to free. */
typedef struct {
    const hs_cl *cl;
    size_t bytes;
    cl_mem buffer; /* what kernels read after hs_device_bytes_bring; not owned: one of the following */
    cl_mem copy;   /* a device's own memory; NULL while host memory is wrapped */
    struct {
        const uint8_t *host;
        cl_mem buffer;
    } wrap[HS_WRAP_COUNT];
    uint32_t wrap_next; /* the oldest wrapping: the next to go */
} hs_device_bytes;

/* For arrays of `bytes` bytes. `wrapped`: a CPU reads them in place; else they are copied, to a buffer with
 * one byte behind them. HS_ERR_DEVICE. */
bool hs_device_bytes_init(hs_device_bytes *bytes, const hs_cl *cl, size_t count, bool wrapped, hs_error *err);

/* Enqueues the way of `host` to the device; does not wait. It must stay, unchanged, until the commands that
 * read it have run; in place, allocated until hs_device_bytes_free. Host buffers that come again create no
 * OpenCL object. HS_ERR_DEVICE. */
bool hs_device_bytes_bring(hs_device_bytes *bytes, const uint8_t *host, hs_error *err);

/* The queue must have run. */
void hs_device_bytes_free(hs_device_bytes *bytes);

#endif
