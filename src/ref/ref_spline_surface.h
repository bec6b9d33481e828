/* SPDX-License-Identifier: MIT */
/* Around the spline: the points it takes and the pixels it gives. */
#ifndef SV_REF_SPLINE_SURFACE_H
#define SV_REF_SPLINE_SURFACE_H

#include "ref/ref_method.h"
#include "ref/ref_spline.h"

/* Algorithm 4.2: the means of the initial points in every cell of a grid x grid raster; 0: the points as they
 * are. x, y, z: room for width * height. Returns the number of points. */
uint32_t sv_ref_merge(const sv_ref_map *map, uint32_t grid, double *x, double *y, double *z);

/* Every pixel of a map, or, with cells > 0, bilinear between the nodes of `cells` x `cells` cells. */
void sv_ref_spline_surface(const sv_ref_spline *spline, uint32_t width, uint32_t height, uint32_t cells,
                           double *surface);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_spline;

#endif
