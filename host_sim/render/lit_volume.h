/* SPDX-License-Identifier: MIT */
/*
 * What the lit look draws, made on the device once per volume (cl/lit_volume.cl): the volume halved and
 * smoothed, with a border of empty voxels; its brick maxima; and two coarse grids, of mean opacities, for
 * light, and of what was scanned, for the scan's own faces.
 */
#ifndef HS_LIT_VOLUME_H
#define HS_LIT_VOLUME_H

#include "render/halved.h"
#include "render/scan_share.h"

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
    /* f, hs_lit_volume_factor. Index i of the source's voxels along an axis is
     * (i - (f - 1) / 2) / f + HS_LIT_BORDER in the smoothed volume. */
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
