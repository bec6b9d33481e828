/* SPDX-License-Identifier: MIT */
#include "bench/methods_reference.h"

#include "ref/ref_chain.h"
#include "spline/spline_shared.h"

#include <math.h>
#include <stdlib.h>

double methods_reference_cost(const methods_map *map, const methods_variant *v) {
    const double n = map->n, pixels = n * n;
    const double points =
        fmin(map->points, v->merge_grid ? v->merge_grid * v->merge_grid : SV_SPLINE_MAX_POINTS);
    const uint32_t reach = v->k / 2;
    if (v->method == SV_METHOD_SPLINE) /* elimination; a logarithm a pixel and point */
        return points * points * points + 10.0 * pixels * points;
    /* filters: k^2 a pixel and pass; gaps of 0.385 sides, k / 2 of which a pass closes */
    return pixels * v->k * v->k * ceil(0.385 * n / reach);
}

double *methods_reference_make(const methods_map *map, const methods_variant *v, float q, hs_error *err) {
    const size_t count = (size_t)map->n * map->n;
    double *depth = malloc(count * sizeof *depth), *surface = malloc(count * sizeof *surface);
    sv_ref_settings settings = sv_ref_default_settings; /* the plugin's */
    settings.kernel = v->k;
    settings.merge_grid = v->merge_grid;
    const sv_ref_task task = {
        .map = {.status = map->status, .depth = depth, .width = map->n, .height = map->n},
        .settings = &settings};
    /* In float32, as the minimum filter gets them: it must be exact. */
    for (size_t i = 0; depth && i < count; i++)
        depth[i] = (double)((float)map->far_end[i] + q * ((float)map->near_end[i] - (float)map->far_end[i]));
    const bool ok = depth && surface && sv_ref_chain(sv_ref_method_of(v->method), &task, surface, NULL);
    free(depth);
    if (ok) return surface;
    free(surface);
    (void)hs_fail(err, HS_ERR_MEMORY, "definition of %s: no memory for %zu pixels", v->label, count);
    return NULL;
}

bool methods_reference_same(const methods_variant *a, const methods_variant *b) {
    return a->method == b->method && a->k == b->k && a->merge_grid == b->merge_grid;
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
