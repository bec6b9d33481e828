/* SPDX-License-Identifier: MIT */
/* The thin-plate spline (thesis Eq. 3.2 to 3.15). */
#pragma once

#include "ref/ref_method.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- a small dense solver: Gaussian elimination with partial pivoting */

/* Factors a (n x n, row by row) in place; false if it is singular to working precision. */
bool sv_ref_factor(double *a, uint32_t n, uint32_t *pivots);
/* Solves with the factors; b becomes the solution. */
void sv_ref_solve(const double *a, uint32_t n, const uint32_t *pivots, double *b);

/* ---- the spline */

/* Coefficients of one spline over `count` points. */
typedef struct {
    uint32_t count,
        rank; /* control points; columns of the plane that count: 3, collinear 2, a single one 1 */
    double *x, *y, *w;
    double mean_x, mean_y, axis_x, axis_y; /* the plane's coordinates: along and across the main axis */
    double plane[3];
    bool singular; /* no solution: coincident points that were not merged */
} sv_ref_spline;

/* phi(r) = r^2 ln r, from r^2. */
double sv_ref_phi(double r_squared);

/* Solves for the points (x, y) with depths z. */
bool sv_ref_spline_solve(const double *x, const double *y, const double *z, uint32_t count, double lambda,
                         sv_ref_spline *out);
void sv_ref_spline_free(sv_ref_spline *spline);

/* ---- the points it takes and the pixels it gives */

/* Algorithm 4.2: the means of the initial points in every cell of a grid x grid raster; 0: the points as they
 * are. x, y, z: room for width * height. Returns the number of points. */
uint32_t sv_ref_merge(const sv_ref_map *map, uint32_t grid, double *x, double *y, double *z);
