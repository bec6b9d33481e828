/* SPDX-License-Identifier: MIT */
/*
 * How much of every place was scanned, made on the device once per volume (cl/lit_scanned.cl). Its slope is
 * the direction of the scan's own faces: there voxels are in or out, and their own gradient shows the
 * staircase.
 */
#ifndef HS_SCAN_SHARE_H
#define HS_SCAN_SHARE_H

#include "render/host_cl.h"

typedef struct hs_scan_share hs_scan_share;

#define HS_SCAN_SHARE_BORDER 2 /* cubes of 0 on every side */

/* For n[0] * n[1] * n[2] marks, in cubes of edge^3 of them; edge is 21 at most. Takes no memory of the device
 * yet. NULL with HS_ERR_MEMORY. `cl` must outlive it. */
hs_scan_share *hs_scan_share_create(const hs_cl *cl, const uint32_t n[3], uint32_t edge, hs_error *err);
void hs_scan_share_destroy(hs_scan_share *share);

/* The buffer is owned by the scan share. Mark i along an axis is at (i - (w - 1) / 2) / w +
 * HS_SCAN_SHARE_BORDER. */
typedef struct {
    cl_mem scanned; /* one byte a cube, x fastest; 0 .. 255: the share, smoothed twice with 1, 2, 1 */
    cl_int4 dims;   /* cubes with their border; w: marks along a cube's edge */
} hs_scan_share_view;

/* Enqueues it for these marks (one byte each, x fastest): from `all` on all of one was scanned, one less is a
 * half of `all` 2 and nothing of `all` 1. Takes its memory the first time; does not wait. HS_ERR_DEVICE. */
bool hs_scan_share_make(hs_scan_share *share, cl_mem marks, uint32_t all, hs_scan_share_view *view,
                        hs_error *err);

#endif
