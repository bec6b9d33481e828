/* SPDX-License-Identifier: MIT */
/*
 * What is made of a source volume on the device, once per volume: what the thesis' renderer may skip, the
 * halved volume, and what the lit look draws.
 */
#pragma once

#include "render/host_kernels.h"

/*
 * A brick has 8 sample positions per edge (BRICK_SHIFT in cl/base.cl), and its maximum covers one voxel more
 * on the far sides, so that it bounds every trilinear sample whose lower corner lies in the brick. So there
 * are max(1, ceil((n - 1) / 8)) bricks along an axis of n voxels.
 */
typedef struct {
    cl_mem maxima; /* one byte each, x fastest */
    cl_int4 count; /* w: 0 */
} hs_brick_view;

#define HS_HALVED_BORDER 2 /* empty voxels on every side of `mean` */

/*
 * A halved voxel stands for 2 x 2 x 2 source voxels; where an axis is odd the last one stands twice. Source
 * index i is (i - 0.5) / 2 here. One byte a voxel, x fastest.
 */
typedef struct {
    cl_int4 dims; /* halved voxels, ceil(n / 2); w: HS_HALVED_BORDER */
    /* The mean of all eight, (sum + 4) / 8; HS_HALVED_BORDER voxels of 0 around. NULL if the lit look does
     * not draw it: hs_lit_view.factor is 1. */
    cl_mem mean;
    /* The same, 2 at least, where all eight were scanned (> 0); 1 where some were, 0 where none was. */
    cl_mem marked;
} hs_halved_view;

#define HS_SCAN_SHARE_BORDER 2 /* cubes of 0 on every side */

/*
 * How much of every place was scanned (cl/lit_volume.cl). Its slope is the direction of the scan's own faces:
 * there voxels are in or out, and their own gradient shows the staircase. Mark i along an axis is at
 * (i - (w - 1) / 2) / w + HS_SCAN_SHARE_BORDER.
 */
typedef struct {
    cl_mem scanned; /* one byte a cube, x fastest; 0 .. 255: the share, smoothed twice with 1, 2, 1 */
    cl_int4 dims;   /* cubes with their border; w: marks along a cube's edge, 21 at most */
} hs_scan_share_view;

#define HS_LIT_BORDER HS_HALVED_BORDER /* empty voxels on every side */

/*
 * What the lit look draws (cl/lit_volume.cl): the volume halved and smoothed, with a border of empty voxels;
 * its brick maxima; and two coarse grids, of mean opacities, for light, and of what was scanned, for the
 * scan's own faces.
 */
typedef struct {
    /* f: source voxels along a smoothed one's edge, 2, or 1 up to 96 voxels along the longest axis. Index i
     * of the source's voxels along an axis is (i - (f - 1) / 2) / f + HS_LIT_BORDER in the smoothed volume.
     */
    uint32_t factor;
    cl_mem smooth; /* one byte each, x fastest */
    cl_int4 dims;  /* smoothed voxels */
    hs_brick_view bricks;
    cl_mem opacity;           /* one byte each, 0 .. 255: 0 .. 1 */
    cl_int4 cells;            /* w: smoothed voxels along a cell's edge */
    hs_scan_share_view share; /* of the smoothed voxels without their border */
} hs_lit_view;

/* All of it, with its buffers. */
typedef struct hs_derived hs_derived;

/* For volumes of n[0] * n[1] * n[2] voxels, 2048 an axis at most. Takes no memory of the device yet. NULL
 * with HS_ERR_MEMORY. `cl` must outlive it. */
hs_derived *hs_derived_create(const hs_cl *cl, const uint32_t n[3], hs_error *err);
void hs_derived_destroy(hs_derived *derived);

/* There is another volume: what was made of the last one does not hold any more. */
void hs_derived_expire(hs_derived *derived);

/*
 * Each enqueues what is missing for these voxels (one byte each, x fastest), and takes its memory the first
 * time; does not wait. Buffers of the view are owned by `derived`. HS_ERR_DEVICE. Opacities are 0 at
 * threshold_low, 1 at threshold_high and above; 0 .. 1 each.
 */
bool hs_derived_bricks(hs_derived *derived, cl_mem voxels, hs_brick_view *view, hs_error *err);
bool hs_derived_halved(hs_derived *derived, cl_mem voxels, hs_halved_view *view, hs_error *err);
bool hs_derived_lit(hs_derived *derived, cl_mem voxels, float threshold_low, float threshold_high,
                    hs_lit_view *view, hs_error *err);
