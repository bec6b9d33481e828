/* SPDX-License-Identifier: MIT */
#include "ref/ref_chain.h"

#include "ref/ref_minimum.h"

#include <stdlib.h>

#define SV_REF_METHOD_ENTRY(NAME, value, key) [value] = {#key, &sv_ref_method_##key},
static const struct {
    const char *name;
    const sv_ref_method *definition;
} methods[SV_METHOD_END] = {SV_METHODS(SV_REF_METHOD_ENTRY)};
#undef SV_REF_METHOD_ENTRY

const sv_ref_settings sv_ref_default_settings = {.kernel = 23, .fill_weight = 0.5, .prefilter_kernel = 5};

const sv_ref_method *sv_ref_method_of(uint32_t method) {
    return method < SV_METHOD_END ? methods[method].definition : NULL;
}

const char *sv_ref_method_name(uint32_t method) {
    return method < SV_METHOD_END ? methods[method].name : NULL;
}

/* float32 divides a position by three samples a slice: at most 8 half steps at the largest depth. */
double sv_ref_bound(const sv_ref_method *method, const sv_ref_task *task, const sv_ref_device *device) {
    const bool rounded = !method->takes_volume && device->substeps == 3;
    return method->bound(task, device) + (rounded ? 8.0 * device->slices * 0x1p-24 : 0.0);
}

bool sv_ref_chain(const sv_ref_method *method, const sv_ref_task *task, double *surface) {
    const sv_ref_settings *s = task->settings;
    sv_ref_task inner = *task;
    if (method->takes_volume || s->prefilter_passes == 0) return method->surface(task, surface);
    double *filtered = malloc((size_t)task->map.width * task->map.height * sizeof *filtered);
    bool ok =
        filtered && sv_ref_minimum_prefilter(&task->map, s->prefilter_kernel, s->prefilter_passes, filtered);
    inner.map.depth = filtered;
    ok = ok && method->surface(&inner, surface);
    free(filtered);
    return ok;
}
