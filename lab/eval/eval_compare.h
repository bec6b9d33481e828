/* SPDX-License-Identifier: MIT */
/* Several plugins or settings on the same volumes: ranked, with the difference per case and its spread. */
#pragma once

#include "eval/eval_case.h"
#include "eval/eval_study.h"

#define HS_EVAL_MAX_METHODS 16u
#define HS_EVAL_MAX_SEEDS   100u

/* What is kept of a method on a volume: e_abs at its setting, the lowest over its knob, and two shares. */
typedef enum {
    HS_METHOD_ABS,
    HS_METHOD_BEST,
    HS_METHOD_CUT,  /* HS_MEASURE_FETUS_CUT */
    HS_METHOD_LEFT, /* HS_MEASURE_OCCLUDER_LEFT */
    HS_METHOD_COUNT
} hs_method_measure;

/* One entry of a comparison. */
typedef struct {
    char label[256]; /* as it was given */
    char path[1024];
    const char *sets[HS_EVAL_MAX_SETS]; /* point into `text` */
    char text[1024];
    uint32_t set_count;
    hs_plugin plugin;
    hs_eval_values values;
    hs_eval_knob knob;
    uint32_t no_surface; /* frames that were not clipped, of cases * seeds */
    float of[HS_METHOD_COUNT][HS_EVAL_MAX_CASES][HS_EVAL_MAX_SEEDS]; /* by case and seed */
    uint32_t map_crc[HS_EVAL_MAX_CASES][HS_EVAL_MAX_SEEDS];          /* hs_eval_map_crc, at its setting */
} hs_eval_method;

/* Owned by the caller; must not move while open. */
typedef struct {
    const hs_eval_options *options;
    hs_cl cl;
    uint32_t count, seeds;
    hs_eval_method method[HS_EVAL_MAX_METHODS];
    uint32_t rank[HS_EVAL_MAX_METHODS]; /* indices into method, the lowest mean e_abs first */
    char name[HS_EVAL_MAX_CASES][64];
    char doubt[HS_EVAL_MAX_CASES][400]; /* hs_eval_source */
    bool truth_cut[HS_EVAL_MAX_CASES];  /* the truth's picture shows a cut (hs_truth_shows_cut) */
    float unclipped[HS_EVAL_MAX_CASES][HS_EVAL_MAX_SEEDS];
} hs_eval_comparison;

/* Opens the device and every method of options->compare; `options` must outlive it. HS_ERR_USAGE for a text
 * that is no method, HS_ERR_PLUGIN, HS_ERR_DEVICE. On failure everything is freed. */
bool hs_eval_compare_open(hs_eval_comparison *x, const hs_eval_options *options, hs_error *err);

/* False with HS_ERR_PLUGIN if a guarded plugin ended before it was to. */
bool hs_eval_compare_close(hs_eval_comparison *x, hs_error *err);

/* Makes the volume of case `index` with seed `seed` (0 .. x->seeds - 1: options->seed and others, 1000 apart)
 * and measures every method on it. Then `c` is open, for pictures, and the caller closes it
 * (hs_eval_case_close); on failure it is closed. */
bool hs_eval_compare_measure(hs_eval_comparison *x, uint32_t index, uint32_t seed, hs_eval_case *c,
                             hs_error *err);

/* Fills x->rank, when all volumes are measured. */
void hs_eval_compare_rank(hs_eval_comparison *x);

/* Mean over cases and seeds. */
double hs_eval_method_mean(const hs_eval_comparison *x, uint32_t method, hs_method_measure measure);

/* e_abs of a method minus that of another on one case: the mean over the seeds, and the sample standard
 * deviation of the seeds' differences (NAN for one seed). The difference exceeds the spread if
 * |mean| > spread. */
typedef struct {
    double mean, spread;
    bool exceeds;
} hs_eval_difference;
hs_eval_difference hs_eval_compare_case(const hs_eval_comparison *x, uint32_t method, uint32_t against,
                                        uint32_t index);
