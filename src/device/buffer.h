/* SPDX-License-Identifier: MIT */
/* Buffers on the device. A queue with a tally counts them instead, so that the code that makes them can be
 * asked first how much it will want. */
#ifndef SV_BUFFER_H
#define SV_BUFFER_H

#include "device/queue.h"

/* A buffer of at least one byte, zeroed by the queue; or NULL and the reason in *status. Does nothing if
 * *status is not SV_OK. */
cl_mem sv_buffer_make(const sv_queue *queue, size_t bytes, sv_status *status);

/* `count` of them, of bytes[i] bytes. Returns the first error; the others are NULL then. */
sv_status sv_buffers_make(const sv_queue *queue, const size_t *bytes, size_t count, cl_mem *buffers);

/* Waits for the queue and reads the buffer's first bytes. SV_ERR_OPENCL names the call with `what`. */
sv_status sv_buffer_read(const sv_queue *queue, cl_mem buffer, size_t bytes, void *out, const char *what);

/* A buffer that the device only reads, wrapped around `memory` of the host, which must outlive it; it
 * counts as none. */
cl_mem sv_buffer_wrap(const sv_queue *queue, const void *memory, size_t bytes, sv_status *status);

/* clReleaseMemObject that takes NULL, and nulls. */
void sv_buffer_release(cl_mem *buffer);

#endif
