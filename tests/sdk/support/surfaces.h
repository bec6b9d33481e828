/* SPDX-License-Identifier: MIT */
/* Reconstruction methods under test: point sets as volumes, frames with a method, and what the definition
 * says. */
#pragma once

#include "support/rig.h"

#include "method_list.h"
#include "ref/ref_chain.h"

/* The method of the list (method_list.h) behind this one, the first behind -1; -1 behind the last. Of all,
 * and of those that start from initial points and not from the volume. */
int surface_next(int method);
int surface_next_of_points(int method);
const char *surface_name(int method);

/* One chain. Zeroed: mean filter, k = 23, no pre-filter, no merging, spline at every pixel. */
typedef struct {
    int method;
    uint32_t k;                             /* 0: 23 */
    uint32_t prefilter_passes, prefilter_k; /* passes 0: no pre-filter */
    double lambda;
    uint32_t merge_grid, spline_grid;
    bool float32;      /* precision float32 */
    uint32_t strategy; /* work layout; 0: auto */
    float q;
} surface_chain;

/* Initial points of a map: status, and both ends in slices (whole numbers). */
typedef struct {
    uint32_t width, height, slices;
    uint8_t *status;
    double *near_end, *far_end;
} surface_points;

surface_points surface_points_make(uint32_t width, uint32_t height, uint32_t slices);
/* 0 <= near < far < slices. */
void surface_put(surface_points *points, uint32_t x, uint32_t y, uint32_t near_end, uint32_t far_end);

/* `count` points anywhere, near and far ends anywhere in the volume. */
surface_points surface_scattered(uint32_t width, uint32_t height, uint32_t slices, uint32_t count,
                                 uint32_t seed);
/* What bones give: about 3 % of the pixels, in round patches with wide gaps between. Far ends vary smoothly
 * within a patch, and from patch to patch by half of the slices. */
surface_points surface_patches(uint32_t width, uint32_t height, uint32_t slices, uint32_t seed);

/* A volume whose initial points are these, with T_B = 0.74 and T_L as by default. */
uint8_t *surface_volume(const surface_points *points);

/* That volume in one slab of host memory, and what the chain tells activate. */
rig_format surface_format(const rig *r, const surface_points *points, const surface_chain *chain);

/* A frame on the host's queue. */
sv_status surface_run(rig *r, const surface_points *points, const surface_chain *chain, rig_result *out);

/* The surface by definition, in float64. */
double *surface_expect(const surface_points *points, const surface_chain *chain);

/* Largest difference; NAN if a depth is not finite. */
double surface_error(const rig_result *out, const double *expected, size_t count);

/* A frame of the chain, which must succeed: its error against `expected`, or, if that is NULL, against the
 * definition. `out` may be NULL. */
double surface_try(rig *r, const surface_points *points, const surface_chain *chain, const double *expected,
                   rig_result *out);

/* Fails unless statistics and status map name the points that there are: none with method wall, which looks
 * for none. */
void surface_check_points(const rig_result *out, const surface_points *points, int method);

/* The method's own bound, on a device with float64 unless the chain says float32. */
double surface_bound(const surface_chain *chain, const surface_points *points);
