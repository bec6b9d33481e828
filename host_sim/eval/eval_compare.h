/* SPDX-License-Identifier: MIT */
/* Several plugins or settings on the same volumes: ranked, with the difference per case and its spread. */
#ifndef HS_EVAL_COMPARE_H
#define HS_EVAL_COMPARE_H

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
    uint32_t no_surface; /* frames without SV_OK, of cases * seeds */
    float of[HS_METHOD_COUNT][HS_EVAL_MAX_CASES][HS_EVAL_MAX_SEEDS]; /* by case and seed */
} hs_eval_method;

typedef struct {
    const hs_eval_options *options;
    hs_cl cl;
    uint32_t count, seeds;
    hs_eval_method method[HS_EVAL_MAX_METHODS];
    uint32_t rank[HS_EVAL_MAX_METHODS]; /* indices into method, the lowest mean e_abs first */
    char name[HS_EVAL_MAX_CASES][64];
    float unclipped[HS_EVAL_MAX_CASES][HS_EVAL_MAX_SEEDS];
} hs_eval_comparison;

/* Mean over cases and seeds. */
double hs_eval_method_mean(const hs_eval_comparison *x, uint32_t method, hs_method_measure measure);

/* e_abs of a method minus that of another on one case: the mean over the seeds, and the sample standard
 * deviation of the seeds' differences (NAN for one seed). The difference exceeds the spread if |mean| >
 * spread. */
typedef struct {
    double mean, spread;
    bool exceeds;
} hs_eval_difference;
hs_eval_difference hs_eval_compare_case(const hs_eval_comparison *x, uint32_t method, uint32_t against,
                                        uint32_t index);

/* Runs options->compare and writes compare.csv and index.html. Seed 0 of a case is options->seed, the others
 * follow. */
bool hs_eval_compare(const hs_eval_options *options, hs_error *err);

/* Renderings of an open case by all methods, with what the first of them is drawn from
 * (host_sim/report/report_pictures_compare.c). The case's loop is gone afterwards. */
bool hs_eval_compare_pictures(const hs_eval_comparison *x, uint32_t index, hs_eval_case *c, hs_error *err);

/* The folder of a case's pictures, and a method's picture in it. */
bool hs_eval_compare_folder(const hs_eval_comparison *x, uint32_t index, char *out, size_t bytes,
                            hs_error *err);
void hs_eval_compare_file(uint32_t method, char *out, size_t bytes);

/* The page (host_sim/report/report_page_compare.c). */
bool hs_eval_compare_page(const hs_eval_comparison *x, hs_error *err);

#endif
