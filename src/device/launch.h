/* SPDX-License-Identifier: MIT */
/* Setting arguments and launching a kernel, with the first error kept. */
#ifndef SV_LAUNCH_H
#define SV_LAUNCH_H

#include "common/sv_shared.h"
#include "device/queue.h"

/* Collects arguments in order; the first failing call is remembered and later calls do nothing. */
typedef struct {
    const sv_queue *queue;
    cl_kernel kernel;
    const char *name;
    cl_uint next;
    cl_int code;
} sv_launch;

sv_launch sv_launch_begin(const sv_queue *queue, cl_kernel kernel, const char *name);
/* The same with the frame's job as the first argument. */
sv_launch sv_launch_job(const sv_queue *queue, cl_kernel kernel, const char *name, const sv_job *job);
void sv_launch_arg(sv_launch *launch, size_t bytes, const void *value);
void sv_launch_buffer(sv_launch *launch, cl_mem buffer);
void sv_launch_uint(sv_launch *launch, uint32_t value);

/* One work item per row or band (local size 1), or per pixel (local size SV_RAYS_LOCAL, x rounded up). */
sv_status sv_launch_items(sv_launch *launch, size_t items, sv_stage stage);
sv_status sv_launch_pixels(sv_launch *launch, uint32_t width, uint32_t height, sv_stage stage);
#define SV_RAYS_LOCAL 32

/* Work groups of SV_GROUP_ITEMS, for kernels whose work items share local memory. */
sv_status sv_launch_groups(sv_launch *launch, size_t groups, sv_stage stage);
#define SV_GROUP_ITEMS 64

/* Any 2D range; local size 1. */
sv_status sv_launch_grid(sv_launch *launch, size_t items_x, size_t items_y, sv_stage stage);

/* One work item per vector of SV_LANES pixels of a padded row. */
sv_status sv_launch_vectors(sv_launch *launch, uint32_t padded_width, uint32_t height, sv_stage stage);

#endif
