/* SPDX-License-Identifier: MIT */
/* Reduced resolution: a method on a map of cells of `reduction` x `reduction` pixels. */
#ifndef SV_REF_REDUCE_H
#define SV_REF_REDUCE_H

#include "ref/ref_map.h"

typedef struct {
    sv_ref_map map; /* of the arrays below */
    uint8_t *status;
    double *depth;
} sv_ref_reduced;

/* The cells' points: mean depth, or the smallest (`minimum`). False if memory runs out. */
bool sv_ref_reduce(const sv_ref_map *map, uint32_t reduction, bool minimum, sv_ref_reduced *out);
void sv_ref_reduced_free(sv_ref_reduced *reduced);

/* Bilinear between the cells' centres, constant beyond the outermost. width, height: of `surface`. */
void sv_ref_spread(const double *cells, uint32_t width, uint32_t height, uint32_t reduction, double *surface);

#endif
