/* SPDX-License-Identifier: MIT */
/* The float64 definitions of the methods on the benchmark's points, and how far a map is from them. */
#ifndef METHODS_REFERENCE_H
#define METHODS_REFERENCE_H

#include "bench/methods_map.h"
#include "bench/methods_variant.h"

typedef struct {
    bool known; /* false: the definition was left out, it would take too long */
    double largest, mean;
} methods_error;

/* Operations, roughly, that the scalar definition of this method takes on this map. */
double methods_reference_cost(const methods_map *map, const methods_variant *variant);

/*
 * The surface that the method means, n * n slices, or NULL with HS_ERR_MEMORY. What is an approximation in
 * the variant (coarse grid, fewer steps, float32) is not one here: splines at every pixel, energies at their
 * minimum. Merging counts as part of the method. Owned by the caller.
 */
double *methods_reference_make(const methods_map *map, const methods_variant *variant, float q,
                               hs_error *err);

/* True if both have the same definition. */
bool methods_reference_same(const methods_variant *a, const methods_variant *b);

/* Of `count` depths from the definition's. A depth that is not finite makes both infinite. */
methods_error methods_error_of(const float *depth, const double *reference, size_t count);

#endif
