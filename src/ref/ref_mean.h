/* SPDX-License-Identifier: MIT */
/* The mean filter (spec 4; thesis Eq. 3.18-3.21, Algorithm 4.3): its definition in float64, and the filter as
 * the kernels compute it. */
#pragma once

#include "quantise.h"
#include "ref/ref_map.h"
#include "ref/ref_method.h"

/* ---- ref_mean.c */

/* float64 definition. `status` != 0 marks initial points; depth in, surface out (may not overlap). False if
 * memory runs out. No initial point: zeros, 0 passes. Ends when every pixel is filled or a pass fills none.
 */
bool sv_ref_mean(const uint8_t *status, const double *depth, uint32_t width, uint32_t height, uint32_t k,
                 double omega, double *surface, sv_ref_fill *fill);

/* ---- ref_mean_fixed.c */

/* The kernels' fixed-point mean filter for both ends at once, to the bit. Positions in samples (substeps per
 * slice); only pixels with status != 0 are read. Surfaces in float32 slices. False if memory runs out. */
bool sv_ref_mean_fixed(const uint8_t *status, const uint32_t *near_position, const uint32_t *far_position,
                       uint32_t width, uint32_t height, uint32_t k, double omega, uint32_t substeps,
                       sv_fixed format, float *near_surface, float *far_surface, sv_ref_fill *fill);
