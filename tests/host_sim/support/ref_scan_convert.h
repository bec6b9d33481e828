/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion's definition (host_sim/render/scan_convert.h) in scalar double precision, one voxel at a
 * time. It shares ref_position and ref_trilinear with the renderer's reference, nothing with the kernels.
 */
#pragma once

#include "render/scan_convert.h"

typedef struct {
    int value;   /* 0 .. 255 */
    double mean; /* before rounding */
    /* Smallest distance of a decision: nearest voxel and face of the box (voxels), half covered (share),
     * rounding of a fraction (twentieths of 1/256 of a halved voxel). */
    double margin;
} ref_lowres;

/* Where samples are taken. */
typedef enum { REF_TRILINEAR, REF_NEAREST, REF_HALVED } ref_way;

/* Samples per axis, and how they are taken. */
ref_way ref_grid(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout, int grid[3]);

/* Voxel (x, y, z) of the low-resolution volume. */
ref_lowres ref_convert_voxel(const hs_volume *volume, const hs_camera *camera, const hs_slab_layout *layout,
                             uint32_t x, uint32_t y, uint32_t z);
