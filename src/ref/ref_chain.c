/* SPDX-License-Identifier: MIT */
#include "ref/ref_chain.h"

#include "quantise.h"
#include "ref/ref_minimum.h"
#include "ref/ref_reduce.h"

#include <stdlib.h>

#define SV_REF_METHOD_ENTRY(NAME, value, key) [value] = {#key, &sv_ref_method_##key},
static const struct {
    const char *name;
    const sv_ref_method *definition;
} methods[SV_METHOD_END] = {SV_METHODS(SV_REF_METHOD_ENTRY)};
#undef SV_REF_METHOD_ENTRY

const sv_ref_settings sv_ref_default_settings = {
    .kernel = 23, .fill_weight = 0.5, .reduction = 1, .prefilter_kernel = 5};

const sv_ref_method *sv_ref_method_of(uint32_t method) {
    return method < SV_METHOD_END ? methods[method].definition : NULL;
}

const char *sv_ref_method_name(uint32_t method) {
    return method < SV_METHOD_END ? methods[method].name : NULL;
}

/* float32 divides a position by three samples a slice; it merges the points of a cell and interpolates
 * between cells. Each costs at most 8 half steps at the largest depth. */
double sv_ref_bound(const sv_ref_method *method, const sv_ref_task *task, const sv_ref_device *device) {
    const double times =
        method->takes_volume ? 0.0 : (task->settings->reduction > 1) + (device->substeps == 3);
    return method->bound(task, device) + times * 8.0 * device->slices * 0x1p-24;
}

/* Runs pre-filter and method on a map whose settings are in its own pixels. */
static bool filter_and_solve(const sv_ref_method *method, sv_ref_task task, double *surface) {
    const sv_ref_settings *s = task.settings;
    if (s->prefilter_passes == 0) return method->surface(&task, surface);
    double *filtered = malloc((size_t)task.map.width * task.map.height * sizeof *filtered);
    bool ok =
        filtered && sv_ref_minimum_prefilter(&task.map, s->prefilter_kernel, s->prefilter_passes, filtered);
    task.map.depth = filtered;
    ok = ok && method->surface(&task, surface);
    free(filtered);
    return ok;
}

/* Runs pre-filter and method on cells, and interpolates at the pixels. */
static bool on_cells(const sv_ref_method *method, const sv_ref_task *task, double *surface) {
    sv_ref_settings s = *task->settings;
    const bool minimum = method->minimum || s.prefilter_passes > 0;
    sv_ref_reduced cells;
    if (!sv_ref_reduce(&task->map, s.reduction, minimum, &cells)) return false;
    s.kernel = sv_reduced_kernel(s.kernel, s.reduction);
    s.prefilter_kernel = sv_reduced_kernel(s.prefilter_kernel, s.reduction);
    s.lambda /= (double)s.reduction * s.reduction; /* an area */
    double *small = malloc((size_t)cells.map.width * cells.map.height * sizeof *small);
    const sv_ref_task inner = {.map = cells.map, .settings = &s};
    const bool ok = small && filter_and_solve(method, inner, small);
    if (ok) sv_ref_spread(small, task->map.width, task->map.height, s.reduction, surface);
    free(small);
    sv_ref_reduced_free(&cells);
    return ok;
}

bool sv_ref_chain(const sv_ref_method *method, const sv_ref_task *task, double *surface) {
    if (method->takes_volume) return method->surface(task, surface);
    if (task->settings->reduction > 1) return on_cells(method, task, surface);
    return filter_and_solve(method, *task, surface);
}
