/* SPDX-License-Identifier: MIT */
/* The chains that are compared: a reconstruction method with its settings. */
#ifndef METHODS_VARIANT_H
#define METHODS_VARIANT_H

#include "method_list.h"
#include "plugin/loader.h"

/* True for a method of the list (method_list.h) that starts from initial points. Those that take the volume
 * are the business of sv_bench and of the judge. */
bool methods_on_points(uint32_t method);

/* Settings that a method does not read are 0 here, and keep their defaults. */
typedef struct {
    const char *label; /* for tables: at most 24 characters */
    uint32_t method;   /* SV_METHOD_* */
    uint32_t k;
    uint32_t merge_grid, spline_grid;
    uint32_t reduction;    /* cells of this many by as many pixels; 0: 1 */
    const char *precision; /* NULL: float64, and exact sums in the mean filter */
    bool quick;            /* part of a --quick run */
} methods_variant;

/* Those whose label is not NULL, until methods_variants_complete has given every method of the list that has
 * no variant the one with its default settings. */
enum { METHODS_VARIANTS = 22 + SV_METHOD_END };
extern methods_variant methods_variants[METHODS_VARIANTS];
void methods_variants_complete(void);

const char *methods_variant_precision(const methods_variant *variant);
uint32_t methods_variant_reduction(const methods_variant *variant);
/* True if a setting trades accuracy for time. */
bool methods_variant_approximates(const methods_variant *variant);

/* A variant as the plugin's parameters: those of activate, and all of them for begin. */
enum { METHODS_MAX_VALUES = 9 };
typedef struct {
    sv_param_value fixed[METHODS_MAX_VALUES], all[METHODS_MAX_VALUES];
    uint32_t fixed_count, count;
} methods_values;

/* HS_ERR_PLUGIN or HS_ERR_USAGE if the plugin lacks one of the parameters. */
bool methods_values_make(const hs_plugin *plugin, const methods_variant *variant, methods_values *values,
                         hs_error *err);

#endif
