/* SPDX-License-Identifier: MIT */
/*
 * The other reconstruction methods in float64, from their written definitions (docs/algorithm.md). All take
 * the status map (!= 0: initial point), a depth per pixel (read at initial points only) and give a surface;
 * none needs OpenCL, none is fast. They return false if memory runs out; without an initial point the surface
 * is 0.
 */
#ifndef SV_REF_METHODS_H
#define SV_REF_METHODS_H

#include "ref/sv_ref.h"

/* A sparse map. Membrane and plate weigh its points, and the plate's bending knows how far apart its pixels
 * lie. */
typedef struct {
    const uint8_t *status;
    const double *depth;
    uint32_t width, height;
    const double *weight; /* points that a point stands for; NULL: 1 each */
    uint32_t spacing;     /* pixels of the depthmap from one of these to the next; 0: 1 */
} sv_ref_map;

/* ---- minimum filter (thesis 3.3, Algorithm 4.4) */

/* Passes of a k x k minimum until no pixel is empty. Minima round nothing, so this is exact. */
bool sv_ref_minimum(const sv_ref_map *map, uint32_t k, double *surface, sv_ref_fill *fill);

/* The pre-filter: `passes` passes, then initial points only. `filtered` holds their new depths. */
bool sv_ref_minimum_prefilter(const sv_ref_map *map, uint32_t k, uint32_t passes, double *filtered);

/* ---- push-pull */

bool sv_ref_pushpull(const sv_ref_map *map, double *surface);

/* ---- thin-plate spline (thesis Eq. 3.2 to 3.15, Algorithm 4.2) */

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

/* Algorithm 4.2: the means of the initial points in every cell of a grid x grid raster; 0: the points as they
 * are. x, y, z: room for width * height. Returns the number of points. */
uint32_t sv_ref_merge(const sv_ref_map *map, uint32_t grid, double *x, double *y, double *z);

/* Every pixel of a map, or, with cells > 0, bilinear between the nodes of `cells` x `cells` cells. */
void sv_ref_spline_surface(const sv_ref_spline *spline, uint32_t width, uint32_t height, uint32_t cells,
                           double *surface);

/* ---- dense solver: Gaussian elimination with partial pivoting */

/* Factors a (n x n, row by row) in place; false if it is singular to working precision. */
bool sv_ref_factor(double *a, uint32_t n, uint32_t *pivots);
/* Solves with the factors; b becomes the solution. */
void sv_ref_solve(const double *a, uint32_t n, const uint32_t *pivots, double *b);
/* Estimate of the inverse's 1-norm for a symmetric matrix (Hager's method). `work`: 3 n values. */
double sv_ref_inverse_norm(const double *a, uint32_t n, const uint32_t *pivots, double *work);

/* ---- membrane and plate: least energy over the pixel grid */

/* Adds the gradient of the energy without its data term, halved, to out. */
typedef void (*sv_ref_energy)(const double *s, uint32_t width, uint32_t height, double spacing, double *out);

/* Of a map whose pixels lie `spacing` apart: a slope squared times a pixel's area does not change with it, a
 * second derivative squared times that area falls by its square. */
void sv_ref_membrane_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out);
void sv_ref_plate_energy(const double *s, uint32_t width, uint32_t height, double spacing, double *out);

/* Conjugate gradients until the residual has fallen by 1e13 or stops falling. */
bool sv_ref_least_energy(const sv_ref_map *map, sv_ref_energy energy, double weight, double *surface);

/* ---- reduced resolution: a method on a map of cells of `reduction` x `reduction` pixels */

typedef struct {
    sv_ref_map map; /* of the arrays below */
    uint8_t *status;
    double *depth, *weight;
} sv_ref_reduced;

/* The cells' points: mean depth, or the smallest (`least`), and how many there were. False if memory runs
 * out. */
bool sv_ref_reduce(const sv_ref_map *map, uint32_t reduction, bool least, sv_ref_reduced *out);
void sv_ref_reduced_free(sv_ref_reduced *reduced);

/* Bilinear between the cells' centres, constant beyond the outermost. width, height: of `surface`. */
void sv_ref_spread(const double *cells, uint32_t width, uint32_t height, uint32_t reduction, double *surface);

#endif
