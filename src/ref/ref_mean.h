/* SPDX-License-Identifier: MIT */
/* The mean filter in float64 (spec 4; thesis Eq. 3.18-3.21, Algorithm 4.3). */
#ifndef SV_REF_MEAN_H
#define SV_REF_MEAN_H

#include "ref/ref_method.h"

/* float64 definition. `status` != 0 marks initial points; depth in, surface out (may not overlap). False if
 * memory runs out. No initial point: zeros, 0 passes. Ends when every pixel is filled or a pass fills none.
 */
bool sv_ref_mean(const uint8_t *status, const double *depth, uint32_t width, uint32_t height, uint32_t k,
                 double omega, double *surface, sv_ref_fill *fill);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_mean;

#endif
