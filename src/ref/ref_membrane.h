/* SPDX-License-Identifier: MIT */
#ifndef SV_REF_MEMBRANE_H
#define SV_REF_MEMBRANE_H

#include "ref/ref_grid.h"

/* The membrane's energy (sv_ref_energy). A slope squared times a pixel's area does not change with the
 * spacing of the pixels. */
void sv_ref_membrane_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_membrane;

#endif
