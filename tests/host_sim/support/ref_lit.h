/* SPDX-License-Identifier: MIT */
/* The lit look's definition (docs/rendering.md) in scalar double precision: one ray, one sample after the
 * other, no skipping. Written from the words; it shares nothing with the kernels but the settings. */
#pragma once

#include "support/ref_dvr.h"

/* --- ref_lit_volume.c: what is drawn of a volume, voxel by voxel. */

#define REF_LIT_BORDER 2 /* empty voxels on every side */

/* What is drawn of a volume. */
typedef struct {
    uint32_t n[3], factor; /* smoothed voxels; source voxels along the edge of one */
    uint8_t *smooth;
    uint32_t cells[3], block; /* cubes of block^3 smoothed voxels */
    uint8_t *opacity;
    uint32_t shares[3], side; /* cubes of side^3 smoothed voxels, and a border of two around them */
    uint8_t *scanned;         /* how much of each was */
} ref_lit_volume;

/* Kept for the test. */
ref_lit_volume ref_lit_make(const hs_volume *volume, const hs_dvr_settings *s);

/* Where a voxel stands among n[0] * n[1] * n[2]. */
size_t ref_lit_index(const uint32_t n[3], uint32_t x, uint32_t y, uint32_t z);

/* Opacity of an intensity (0 .. 255) on a scale where T_L is 0 and T_H 1, not limited; and a value between
 * them. */
double ref_lit_ramp(const hs_dvr_settings *s, double intensity);
double ref_lit_limited(double value);

/* --- ref_lit.c: the picture. */

/* A pixel's red, green and blue, 0 .. 255, not rounded. */
void ref_lit_pixel(const hs_volume *volume, const ref_lit_volume *lit, const hs_camera *camera,
                   const hs_dvr_settings *s, const ref_depthmap *map, uint32_t x, uint32_t y, double rgb[3]);
