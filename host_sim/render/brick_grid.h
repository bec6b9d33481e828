/* SPDX-License-Identifier: MIT */
/* What the thesis' renderer may skip: the largest voxel of every brick, made once
 * per volume (cl/bricks.cl). */
#ifndef HS_BRICK_GRID_H
#define HS_BRICK_GRID_H

#include "render/host_cl.h"

/*
 * A brick has 8 sample positions per edge (BRICK_SHIFT in cl/base.cl), and its maximum covers one voxel more
 * on the far sides, so that it bounds every trilinear sample whose lower corner lies in the brick. So there
 * are max(1, ceil((n - 1) / 8)) bricks along an axis of n voxels.
 */
typedef struct hs_brick_grid hs_brick_grid;

/* For volumes of dims.xyz voxels. Takes no memory of the device yet. NULL with HS_ERR_MEMORY. `cl` must
 * outlive it. */
hs_brick_grid *hs_brick_grid_create(const hs_cl *cl, cl_int4 dims, hs_error *err);
void hs_brick_grid_destroy(hs_brick_grid *grid);

/* There is another volume: the maxima of the last one do not hold any more. */
void hs_brick_grid_expire(hs_brick_grid *grid);

typedef struct {
    cl_mem maxima; /* one byte each, x fastest; owned by the grid */
    cl_int4 count; /* w: 0 */
} hs_brick_view;

/* Enqueues the search for the maxima if this volume has not been searched yet, and takes its memory the first
 * time; does not wait. HS_ERR_DEVICE. */
bool hs_brick_grid_make(hs_brick_grid *grid, cl_mem voxels, hs_brick_view *view, hs_error *err);

#endif
