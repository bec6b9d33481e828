/* SPDX-License-Identifier: MIT */
#include "bench/methods_variant.h"

#include "plugin/loader_param.h"

#include <stdio.h>

static const char *const kind_keys[METHODS_KINDS] = {"mean",     "minimum",  "spline",
                                                     "pushpull", "membrane", "plate"};

const char *methods_kind_key(methods_kind kind) {
    return kind_keys[kind];
}

const char *methods_variant_precision(const methods_variant *v) {
    return v->precision ? v->precision : "float64";
}

uint32_t methods_variant_reduction(const methods_variant *v) {
    return v->reduction ? v->reduction : 1;
}

bool methods_variant_approximates(const methods_variant *v) {
    return v->precision || v->steps > 0 || v->spline_grid > 0 || v->reduction > 1;
}

const methods_variant methods_variants[METHODS_VARIANTS] = {
    {.label = "mean k 3", .kind = METHODS_MEAN, .k = 3},
    {.label = "mean k 11", .kind = METHODS_MEAN, .k = 11, .quick = true},
    {.label = "mean k 23", .kind = METHODS_MEAN, .k = 23, .quick = true},
    {.label = "mean k 55", .kind = METHODS_MEAN, .k = 55, .quick = true},
    {.label = "mean k 3, int16", .kind = METHODS_MEAN, .k = 3, .precision = "int16"},
    {.label = "mean k 23, int16", .kind = METHODS_MEAN, .k = 23, .precision = "int16", .quick = true},
    {.label = "mean k 55, int16", .kind = METHODS_MEAN, .k = 55, .precision = "int16"},
    {.label = "mean k 23, 1/2", .kind = METHODS_MEAN, .k = 23, .reduction = 2, .quick = true},
    {.label = "mean k 23, 1/4", .kind = METHODS_MEAN, .k = 23, .reduction = 4},
    {.label = "minimum k 11", .kind = METHODS_MINIMUM, .k = 11},
    {.label = "minimum k 23", .kind = METHODS_MINIMUM, .k = 23, .quick = true},
    {.label = "minimum k 23, 1/2", .kind = METHODS_MINIMUM, .k = 23, .reduction = 2},
    {.label = "spline m 8, pixels", .kind = METHODS_SPLINE, .merge_grid = 8, .quick = true},
    {.label = "spline m 8, grid 8", .kind = METHODS_SPLINE, .merge_grid = 8, .spline_grid = 8},
    {.label = "spline m 8, grid 16", .kind = METHODS_SPLINE, .merge_grid = 8, .spline_grid = 16},
    {.label = "spline m 8, grid 32",
     .kind = METHODS_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .quick = true},
    {.label = "spline m 8, grid 64", .kind = METHODS_SPLINE, .merge_grid = 8, .spline_grid = 64},
    {.label = "spline m 8, g 32, f32",
     .kind = METHODS_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .precision = "float32",
     .quick = true},
    {.label = "spline m 37, grid 32", .kind = METHODS_SPLINE, .merge_grid = 37, .spline_grid = 32},
    {.label = "spline unmerged, grid 32", .kind = METHODS_SPLINE, .spline_grid = 32},
    {.label = "spline m 8, pixels, 1/2", .kind = METHODS_SPLINE, .merge_grid = 8, .reduction = 2},
    {.label = "spline m 8, pixels, 1/4", .kind = METHODS_SPLINE, .merge_grid = 8, .reduction = 4},
    {.label = "pushpull", .kind = METHODS_PUSHPULL, .quick = true},
    {.label = "pushpull, 1/2", .kind = METHODS_PUSHPULL, .reduction = 2},
    {.label = "membrane", .kind = METHODS_MEMBRANE, .quick = true},
    {.label = "membrane 4 steps", .kind = METHODS_MEMBRANE, .steps = 4, .quick = true},
    {.label = "membrane 8 steps", .kind = METHODS_MEMBRANE, .steps = 8},
    {.label = "membrane f32", .kind = METHODS_MEMBRANE, .precision = "float32"},
    {.label = "membrane 8 steps, f32", .kind = METHODS_MEMBRANE, .steps = 8, .precision = "float32"},
    {.label = "membrane, 1/2", .kind = METHODS_MEMBRANE, .reduction = 2, .quick = true},
    {.label = "membrane, 1/4", .kind = METHODS_MEMBRANE, .reduction = 4, .quick = true},
    {.label = "membrane 4 steps, 1/4", .kind = METHODS_MEMBRANE, .steps = 4, .reduction = 4},
    {.label = "plate", .kind = METHODS_PLATE, .quick = true},
    {.label = "plate 12 steps", .kind = METHODS_PLATE, .steps = 12, .quick = true},
    {.label = "plate 18 steps", .kind = METHODS_PLATE, .steps = 18},
    {.label = "plate 24 steps", .kind = METHODS_PLATE, .steps = 24},
    {.label = "plate f32", .kind = METHODS_PLATE, .precision = "float32"},
    {.label = "plate, 1/2", .kind = METHODS_PLATE, .reduction = 2},
    {.label = "plate, 1/4", .kind = METHODS_PLATE, .reduction = 4, .quick = true},
    {.label = "plate 24 steps, 1/4", .kind = METHODS_PLATE, .steps = 24, .reduction = 4},
};

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
    return add(plugin, "method", kind_keys[v->kind], values, err) &&
           (v->k == 0 || add_number(plugin, "kernel", v->k, values, err)) &&
           (v->kind != METHODS_SPLINE || (add_number(plugin, "merge_grid", v->merge_grid, values, err) &&
                                          add_number(plugin, "spline_grid", v->spline_grid, values, err))) &&
           add_number(plugin, "solver_steps", v->steps, values, err) &&
           add_number(plugin, "reduction", methods_variant_reduction(v), values, err) &&
           add(plugin, "precision", methods_variant_precision(v), values, err);
}
