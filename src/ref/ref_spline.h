/* SPDX-License-Identifier: MIT */
/* The thin-plate spline (thesis Eq. 3.2 to 3.15). */
#ifndef SV_REF_SPLINE_H
#define SV_REF_SPLINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Coefficients of one spline over `count` points. */
typedef struct {
    uint32_t count,
        rank; /* control points; columns of the plane that count: 3, collinear 2, a single one 1 */
    double *x, *y, *w;
    double mean_x, mean_y, axis_x, axis_y; /* the plane's coordinates: along and across the main axis */
    double plane[3];
    double condition; /* estimate of the matrix' condition number in the 1-norm */
    double residual;  /* largest error of Eq. 3.3 (with lambda) at a control point */
    bool singular;    /* no solution: coincident points that were not merged */
} sv_ref_spline;

/* phi(r) = r^2 ln r, from r^2. */
double sv_ref_phi(double r_squared);

/* Solves for the points (x, y) with depths z. */
bool sv_ref_spline_solve(const double *x, const double *y, const double *z, uint32_t count, double lambda,
                         sv_ref_spline *out);
double sv_ref_spline_at(const sv_ref_spline *spline, double x, double y);
void sv_ref_spline_free(sv_ref_spline *spline);

#endif
