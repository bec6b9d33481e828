/* SPDX-License-Identifier: MIT */
/* The queue, buffers on the device, and launches of kernels. */
#pragma once

#include "common/sv_shared.h"
#include "device/device.h"
#include "device/timing.h"

/* What was asked of a queue that only counts: bytes of buffers, all together and of the largest; commands. */
typedef struct {
    uint64_t bytes, largest;
    uint32_t commands;
} sv_tally;

typedef struct {
    sv_diag *diag;
    const sv_device *device;
    sv_timing *timing; /* NULL: no times are taken */
    sv_tally *tally;   /* not NULL: buffers and commands are counted here, and OpenCL is not called */
} sv_queue;

/* ---- buffers: a queue with a tally counts them and makes none, which tells how much code will want */

/* Makes a buffer of at least one byte, zeroed by the queue. On failure it returns NULL and the reason in
 * *status. It does nothing if *status is not SV_OK. */
cl_mem sv_buffer_make(const sv_queue *queue, size_t bytes, sv_status *status);

/* Enqueues zeros for `bytes` bytes. */
sv_status sv_buffer_clear(const sv_queue *queue, cl_mem buffer, size_t bytes);

/* Makes `count` buffers of bytes[i] bytes. Returns the first error; the others are NULL then. */
sv_status sv_buffers_make(const sv_queue *queue, const size_t *bytes, size_t count, cl_mem *buffers);

/* Waits for the queue and reads the buffer's first bytes. SV_ERR_OPENCL names the call with `what`. */
sv_status sv_buffer_read(const sv_queue *queue, cl_mem buffer, size_t bytes, void *out, const char *what);

/* Wraps a buffer that the device only reads around `memory` of the host, which must outlive it. It is not
 * counted. */
cl_mem sv_buffer_wrap(const sv_queue *queue, const void *memory, size_t bytes, sv_status *status);

/* Before a command that is enqueued directly: true if the queue has counted it and none must be. */
static inline bool sv_counted(const sv_queue *queue) {
    if (queue->tally) queue->tally->commands++;
    return queue->tally != NULL;
}

/* Releases the buffer, which may be NULL, and sets it to NULL. */
void sv_buffer_release(cl_mem *buffer);

/* ---- launches: the first error is kept */

/* Collects arguments in order; the first failing call is remembered and later calls do nothing. */
typedef struct {
    const sv_queue *queue;
    cl_kernel kernel;
    const char *name;
    cl_uint next;
    cl_int code;
} sv_launch;

sv_launch sv_launch_begin(const sv_queue *queue, cl_kernel kernel, const char *name);
/* Begins a launch whose first argument is the frame's job. */
sv_launch sv_launch_job(const sv_queue *queue, cl_kernel kernel, const char *name, const sv_job *job);
void sv_launch_arg(sv_launch *launch, size_t bytes, const void *value);
void sv_launch_buffer(sv_launch *launch, cl_mem buffer);
void sv_launch_uint(sv_launch *launch, uint32_t value);

/* Launches one work item per row or band (local size 1), or per pixel (local size SV_RAYS_LOCAL, x rounded
 * up). */
sv_status sv_launch_items(sv_launch *launch, size_t items, sv_stage stage);
sv_status sv_launch_pixels(sv_launch *launch, uint32_t width, uint32_t height, sv_stage stage);
#define SV_RAYS_LOCAL 32

/* Launches work groups of SV_GROUP_ITEMS, for kernels whose work items share local memory. */
sv_status sv_launch_groups(sv_launch *launch, size_t groups, sv_stage stage);
#define SV_GROUP_ITEMS 64

/* Launches any 2D range with local size 1. */
sv_status sv_launch_grid(sv_launch *launch, size_t items_x, size_t items_y, sv_stage stage);

/* Launches one work item per vector of SV_LANES pixels of a padded row. */
sv_status sv_launch_vectors(sv_launch *launch, uint32_t padded_width, uint32_t height, sv_stage stage);
