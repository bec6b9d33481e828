/* SPDX-License-Identifier: MIT */
/* The surface of least energy over the pixel grid: what membrane and plate share. */
#ifndef SV_REF_GRID_H
#define SV_REF_GRID_H

#include "ref/ref_method.h"

/* Adds the gradient of the energy without its data term, halved, to out. */
typedef void (*sv_ref_energy)(const double *s, uint32_t width, uint32_t height, double spacing, double *out);

/* Conjugate gradients until the residual has fallen by 1e13 or stops falling. */
bool sv_ref_least_energy(const sv_ref_map *map, sv_ref_energy energy, double weight, double *surface);

#endif
