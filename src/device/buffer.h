/* SPDX-License-Identifier: MIT */
/* Buffers on the device. A queue with a tally counts them instead, so that the code that makes them can be
 * asked first how much it will want. */
#ifndef SV_BUFFER_H
#define SV_BUFFER_H

#include "device/queue.h"

/* A buffer of at least one byte, zeroed by the queue; or NULL and the reason in *status. Does nothing if
 * *status is not SV_OK. */
cl_mem sv_buffer_make(const sv_queue *queue, size_t bytes, sv_status *status);

/* A buffer that the device only reads, wrapped around `memory` of the host, which must outlive it; it
 * counts as none. */
cl_mem sv_buffer_wrap(const sv_queue *queue, const void *memory, size_t bytes, sv_status *status);

/* clReleaseMemObject that takes NULL, and nulls. */
void sv_buffer_release(cl_mem *buffer);

#endif
