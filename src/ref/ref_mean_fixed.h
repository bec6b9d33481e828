/* SPDX-License-Identifier: MIT */
/* The mean filter as the kernels compute it, to the bit. */
#ifndef SV_REF_MEAN_FIXED_H
#define SV_REF_MEAN_FIXED_H

#include "quantise.h"
#include "ref/ref_map.h"

/* The kernels' fixed-point mean filter for both ends at once, to the bit. Positions in samples (substeps per
 * slice); only pixels with status != 0 are read. Surfaces in float32 slices. False if memory runs out. */
bool sv_ref_mean_fixed(const uint8_t *status, const uint32_t *near_position, const uint32_t *far_position,
                       uint32_t width, uint32_t height, uint32_t k, double omega, uint32_t substeps,
                       sv_fixed format, float *near_surface, float *far_surface, sv_ref_fill *fill);

#endif
