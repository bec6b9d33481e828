/* SPDX-License-Identifier: MIT */
#ifndef SV_REF_PLATE_H
#define SV_REF_PLATE_H

#include "ref/ref_grid.h"

/* The plate's energy (sv_ref_energy) of a map whose pixels lie `spacing` apart: a second derivative squared
 * times a pixel's area falls by the spacing's square. */
void sv_ref_plate_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_plate;

#endif
