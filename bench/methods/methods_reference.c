/* SPDX-License-Identifier: MIT */
#include "methods/methods_reference.h"

#include "ref/sv_ref_methods.h"

#include <math.h>
#include <stdlib.h>

/* Points the plugin's solver takes, and the cells per side it merges more of them on. */
enum { SPLINE_POINTS = 1400, SPLINE_GRID = 37 };
static const double omega = 0.5, data_weight = 1.0; /* the plugin's defaults */

double methods_reference_cost(const methods_map *map, const methods_variant *v) {
    const double n = map->n, pixels = n * n;
    const double points = fmin(map->points, v->merge_grid ? v->merge_grid * v->merge_grid : SPLINE_POINTS);
    const uint32_t reach = v->k / 2;
    switch (v->kind) {
    case METHODS_MEAN: /* k^2 a pixel and pass; gaps of 0.385 sides, k / 2 of which a pass closes */
    case METHODS_MINIMUM:
        return pixels * v->k * v->k * ceil(0.385 * n / reach);
    case METHODS_SPLINE: /* elimination; a logarithm a pixel and point */
        return points * points * points + 10.0 * pixels * points;
    case METHODS_PUSHPULL:
        return 10.0 * pixels;
    default: /* conjugate gradients take steps like n for the membrane and like n^2 for the plate */
        return 40.0 * pixels * n * (v->kind == METHODS_PLATE ? n / 2.0 : 1.0);
    }
}

static bool spline(const sv_ref_map *map, uint32_t merge_grid, double *surface) {
    const size_t count = (size_t)map->width * map->height;
    double *x = malloc(3 * count * sizeof *x), *y = x + count, *z = y + count;
    if (!x) return false;
    uint32_t n = sv_ref_merge(map, merge_grid, x, y, z);
    if (merge_grid == 0 && n > SPLINE_POINTS) n = sv_ref_merge(map, SPLINE_GRID, x, y, z);
    sv_ref_spline solved;
    const bool ok = sv_ref_spline_solve(x, y, z, n, 0.0, &solved);
    if (ok) sv_ref_spline_surface(&solved, map->width, map->height, 0, surface);
    if (ok) sv_ref_spline_free(&solved);
    free(x);
    return ok;
}

static bool define(const sv_ref_map *map, const methods_variant *v, double *surface) {
    sv_ref_fill fill;
    switch (v->kind) {
    case METHODS_MEAN:
        return sv_ref_mean(map->status, map->depth, map->width, map->height, v->k, omega, surface, &fill);
    case METHODS_MINIMUM:
        return sv_ref_minimum(map, v->k, surface, &fill);
    case METHODS_SPLINE:
        return spline(map, v->merge_grid, surface);
    case METHODS_PUSHPULL:
        return sv_ref_pushpull(map, surface);
    case METHODS_MEMBRANE:
        return sv_ref_least_energy(map, sv_ref_membrane_energy, data_weight, surface);
    default:
        return sv_ref_least_energy(map, sv_ref_plate_energy, data_weight, surface);
    }
}

double *methods_reference_make(const methods_map *map, const methods_variant *v, float q, hs_error *err) {
    const size_t count = (size_t)map->n * map->n;
    double *depth = malloc(count * sizeof *depth), *surface = malloc(count * sizeof *surface);
    const sv_ref_map points = {.status = map->status, .depth = depth, .width = map->n, .height = map->n};
    /* In float32, as the minimum filter gets them: it must be exact. */
    for (size_t i = 0; depth && i < count; i++)
        depth[i] = (double)((float)map->far_end[i] + q * ((float)map->near_end[i] - (float)map->far_end[i]));
    const bool ok = depth && surface && define(&points, v, surface);
    free(depth);
    if (ok) return surface;
    free(surface);
    (void)hs_fail(err, HS_ERR_MEMORY, "definition of %s: no memory for %zu pixels", v->label, count);
    return NULL;
}

bool methods_reference_same(const methods_variant *a, const methods_variant *b) {
    return a->kind == b->kind && a->k == b->k && a->merge_grid == b->merge_grid;
}

methods_error methods_error_of(const float *depth, const double *reference, size_t count) {
    methods_error error = {.known = true};
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double off = isfinite(depth[i]) ? fabs((double)depth[i] - reference[i]) : (double)INFINITY;
        error.largest = fmax(error.largest, off);
        sum += off;
    }
    error.mean = sum / (double)count;
    return error;
}
