/* SPDX-License-Identifier: MIT */
/* The surface of least energy for maps on which plain conjugate gradients
 * (sv_ref_least_energy) take too long. */
#ifndef SV_ENERGY_H
#define SV_ENERGY_H

#include "ref/ref_grid.h"
#include "ref/ref_map.h"

/*
 * The same equations and the same answer: float64, conjugate gradients until the error in the energy has
 * fallen by 1e12, but with a multigrid cycle as preconditioner. The operator is sv_ref_energy itself, so a
 * mistake in the preconditioner can cost steps, not accuracy. Returns the steps taken; aborts if memory runs
 * out, or if `most` steps do not do.
 */
uint32_t energy_least(const sv_ref_map *map, sv_ref_energy energy, double weight, uint32_t most,
                      double *surface);

#endif
