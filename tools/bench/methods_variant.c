/* SPDX-License-Identifier: MIT */
#include "bench/methods_variant.h"

#include "plugin/loader_param.h"
#include "ref/ref_chain.h"

#include <stdio.h>

const char *methods_variant_precision(const methods_variant *v) {
    return v->precision ? v->precision : "float64";
}

uint32_t methods_variant_reduction(const methods_variant *v) {
    return v->reduction ? v->reduction : 1;
}

bool methods_variant_approximates(const methods_variant *v) {
    return v->precision || v->spline_grid > 0 || v->reduction > 1;
}

methods_variant methods_variants[METHODS_VARIANTS] = {
    {.label = "mean k 3", .method = SV_METHOD_MEAN, .k = 3},
    {.label = "mean k 11", .method = SV_METHOD_MEAN, .k = 11, .quick = true},
    {.label = "mean k 23", .method = SV_METHOD_MEAN, .k = 23, .quick = true},
    {.label = "mean k 55", .method = SV_METHOD_MEAN, .k = 55, .quick = true},
    {.label = "mean k 3, int16", .method = SV_METHOD_MEAN, .k = 3, .precision = "int16"},
    {.label = "mean k 23, int16", .method = SV_METHOD_MEAN, .k = 23, .precision = "int16", .quick = true},
    {.label = "mean k 55, int16", .method = SV_METHOD_MEAN, .k = 55, .precision = "int16"},
    {.label = "mean k 23, 1/2", .method = SV_METHOD_MEAN, .k = 23, .reduction = 2, .quick = true},
    {.label = "mean k 23, 1/4", .method = SV_METHOD_MEAN, .k = 23, .reduction = 4},
    {.label = "minimum k 11", .method = SV_METHOD_MINIMUM, .k = 11},
    {.label = "minimum k 23", .method = SV_METHOD_MINIMUM, .k = 23, .quick = true},
    {.label = "minimum k 23, 1/2", .method = SV_METHOD_MINIMUM, .k = 23, .reduction = 2},
    {.label = "spline m 8, pixels", .method = SV_METHOD_SPLINE, .merge_grid = 8, .quick = true},
    {.label = "spline m 8, grid 8", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 8},
    {.label = "spline m 8, grid 16", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 16},
    {.label = "spline m 8, grid 32",
     .method = SV_METHOD_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .quick = true},
    {.label = "spline m 8, grid 64", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 64},
    {.label = "spline m 8, g 32, f32",
     .method = SV_METHOD_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .precision = "float32",
     .quick = true},
    {.label = "spline m 37, grid 32", .method = SV_METHOD_SPLINE, .merge_grid = 37, .spline_grid = 32},
    {.label = "spline unmerged, grid 32", .method = SV_METHOD_SPLINE, .spline_grid = 32},
    {.label = "spline m 8, pixels, 1/2", .method = SV_METHOD_SPLINE, .merge_grid = 8, .reduction = 2},
    {.label = "spline m 8, pixels, 1/4", .method = SV_METHOD_SPLINE, .merge_grid = 8, .reduction = 4},
};

void methods_variants_complete(void) {
    uint32_t used = 0;
    bool listed[SV_METHOD_END] = {false};
    for (; methods_variants[used].label; used++) listed[methods_variants[used].method] = true;
    for (uint32_t m = 0; m < SV_METHOD_END; m++)
        if (methods_on_points(m) && !listed[m])
            methods_variants[used++] =
                (methods_variant){.label = sv_ref_method_name(m), .method = m, .k = 23, .quick = true};
}

bool methods_on_points(uint32_t method) {
    const sv_ref_method *definition = sv_ref_method_of(method);
    return definition && !definition->takes_volume;
}

static bool add(const hs_plugin *plugin, const char *key, const char *value, methods_values *values,
                hs_error *err) {
    char text[64];
    sv_param_info info = {.size = sizeof info};
    sv_param_value *out = &values->all[values->count];
    (void)snprintf(text, sizeof text, "%s=%s", key, value);
    if (!hs_plugin_parse_param(plugin, text, out, err)) return false;
    if (hs_plugin_find_param(plugin, key, &info) && (info.flags & SV_PARAM_REACTIVATE))
        values->fixed[values->fixed_count++] = *out;
    values->count++;
    return true;
}

static bool add_number(const hs_plugin *plugin, const char *key, uint32_t value, methods_values *values,
                       hs_error *err) {
    char text[16];
    (void)snprintf(text, sizeof text, "%u", value);
    return add(plugin, key, text, values, err);
}

bool methods_values_make(const hs_plugin *plugin, const methods_variant *v, methods_values *values,
                         hs_error *err) {
    *values = (methods_values){0};
    return add(plugin, "method", sv_ref_method_name(v->method), values, err) &&
           (v->k == 0 || add_number(plugin, "kernel", v->k, values, err)) &&
           (v->method != SV_METHOD_SPLINE ||
            (add_number(plugin, "merge_grid", v->merge_grid, values, err) &&
             add_number(plugin, "spline_grid", v->spline_grid, values, err))) &&
           add_number(plugin, "reduction", methods_variant_reduction(v), values, err) &&
           add(plugin, "precision", methods_variant_precision(v), values, err);
}
