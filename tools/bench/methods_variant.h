/* SPDX-License-Identifier: MIT */
/* The chains that are compared: a reconstruction method with its settings. */
#ifndef METHODS_VARIANT_H
#define METHODS_VARIANT_H

#include "plugin/loader.h"

typedef enum {
    METHODS_MEAN,
    METHODS_MINIMUM,
    METHODS_SPLINE,
    METHODS_PUSHPULL,
    METHODS_MEMBRANE,
    METHODS_PLATE,
    METHODS_KINDS
} methods_kind;

/* The value of the plugin's parameter "method": "mean", ... */
const char *methods_kind_key(methods_kind kind);

/* Settings that a method does not read are 0 here, and keep their defaults. */
typedef struct {
    const char *label; /* for tables: at most 24 characters */
    methods_kind kind;
    uint32_t k;
    uint32_t merge_grid, spline_grid;
    uint32_t steps;        /* of the solver; 0: as many as the bound needs */
    uint32_t reduction;    /* cells of this many by as many pixels; 0: 1 */
    const char *precision; /* NULL: float64, and exact sums in the mean filter */
    bool quick;            /* part of a --quick run */
} methods_variant;

enum { METHODS_VARIANTS = 40 };
extern const methods_variant methods_variants[METHODS_VARIANTS];

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
