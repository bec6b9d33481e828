/* SPDX-License-Identifier: MIT */
/*
 * What is made of a source volume on the device, once per volume: what the thesis' renderer may skip, the
 * halved volume, and what the lit look draws.
 */
#ifndef HS_DERIVED_VOLUME_H
#define HS_DERIVED_VOLUME_H

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

#define HS_HALVED_BORDER 2 /* empty voxels on every side of `mean` */

typedef struct hs_halved hs_halved;

/* For volumes of n[0] * n[1] * n[2] voxels. `with_mean`: somebody needs `mean`. Takes no memory of the device
 * yet. NULL with HS_ERR_MEMORY. `cl` must outlive it. */
hs_halved *hs_halved_create(const hs_cl *cl, const uint32_t n[3], bool with_mean, hs_error *err);
void hs_halved_destroy(hs_halved *halved);

/* There is another volume: what was made of the last one does not hold any more. */
void hs_halved_expire(hs_halved *halved);

/*
 * A halved voxel stands for 2 x 2 x 2 source voxels; where an axis is odd the last one stands twice. Source
 * index i is (i - 0.5) / 2 here. Buffers are owned by the halved volume; one byte a voxel, x fastest.
 */
typedef struct {
    cl_int4 dims; /* halved voxels, ceil(n / 2); w: HS_HALVED_BORDER */
    /* The mean of all eight, (sum + 4) / 8; HS_HALVED_BORDER voxels of 0 around. NULL without with_mean. */
    cl_mem mean;
    /* The same, 2 at least, where all eight were scanned (> 0); 1 where some were, 0 where none was. */
    cl_mem marked;
} hs_halved_view;

/* Enqueues the halving if this volume has not been halved yet, and takes its memory the first time; does not
 * wait. HS_ERR_DEVICE. */
bool hs_halved_make(hs_halved *halved, cl_mem voxels, hs_halved_view *view, hs_error *err);

#define HS_SCAN_SHARE_BORDER 2 /* cubes of 0 on every side */

/*
 * How much of every place was scanned (cl/lit_volume.cl). Its slope is the direction of the scan's own faces:
 * there voxels are in or out, and their own gradient shows the staircase. Mark i along an axis is at
 * (i - (w - 1) / 2) / w + HS_SCAN_SHARE_BORDER.
 */
typedef struct {
    cl_mem scanned; /* one byte a cube, x fastest; 0 .. 255: the share, smoothed twice with 1, 2, 1 */
    cl_int4 dims;   /* cubes with their border; w: marks along a cube's edge */
} hs_scan_share_view;

/*
 * What the lit look draws (cl/lit_volume.cl): the volume halved and smoothed, with a border of empty voxels;
 * its brick maxima; and two coarse grids, of mean opacities, for light, and of what was scanned, for the
 * scan's own faces.
 */
typedef struct hs_lit_volume hs_lit_volume;

/* For volumes of n[0] * n[1] * n[2] voxels, 2048 an axis at most. Takes no memory of the device yet. NULL
 * with HS_ERR_MEMORY. `cl` must outlive it. */
hs_lit_volume *hs_lit_volume_create(const hs_cl *cl, const uint32_t n[3], hs_error *err);
void hs_lit_volume_destroy(hs_lit_volume *lit);

/* Source voxels along a smoothed one's edge: 2, or 1 up to 96 voxels along the longest axis. */
uint32_t hs_lit_volume_factor(const uint32_t n[3]);

/* There is another volume: what was made of the last one does not hold any more. */
void hs_lit_volume_expire(hs_lit_volume *lit);

#define HS_LIT_BORDER HS_HALVED_BORDER /* empty voxels on every side */

/* Buffers are owned by the lit volume. */
typedef struct {
    /* f, hs_lit_volume_factor. Index i of the source's voxels along an axis is (i - (f - 1) / 2) / f +
     * HS_LIT_BORDER in the smoothed volume. */
    uint32_t factor;
    cl_mem smooth, brick_maxima; /* one byte each, x fastest */
    cl_int4 dims, bricks;        /* smoothed voxels, bricks (hs_brick_view) */
    cl_mem opacity;              /* one byte each, 0 .. 255: 0 .. 1 */
    cl_int4 cells;               /* w: smoothed voxels along a cell's edge */
    hs_scan_share_view share;    /* of the smoothed voxels without their border */
} hs_lit_view;

/*
 * Enqueues what is missing for these voxels and opacities (0 at T_L, 1 at T_H and above; 0 .. 1 each), and
 * says what to draw. `halved`: of the same voxels, with its mean; not looked at if the factor is 1. Takes its
 * memory the first time; does not wait. HS_ERR_DEVICE.
 */
bool hs_lit_volume_make(hs_lit_volume *lit, cl_mem voxels, hs_halved *halved, float threshold_low,
                        float threshold_high, hs_lit_view *view, hs_error *err);

#endif
