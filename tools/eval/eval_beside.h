/* SPDX-License-Identifier: MIT */
/*
 * Another method of the same plugin beside the one whose space is studied: both on the same volumes, with the
 * true surface as the floor. What is compared is one setting for all cases.
 */
#ifndef HS_EVAL_BESIDE_H
#define HS_EVAL_BESIDE_H

#include "eval/eval_best.h"
#include "eval/eval_options.h"

/* The columns: one setting for all cases each. */
typedef enum {
    HS_BESIDE_DEFAULT, /* the studied method at its defaults */
    HS_BESIDE_KNOB,    /* the same, its knob where the mean e_abs over the cases is lowest */
    HS_BESIDE_TUNED,   /* the same, T_B by Delta_MI, k and knob where it is lowest (Table 5.3, one knob) */
    HS_BESIDE_OTHER,   /* the other method at its defaults */
    HS_BESIDE_TRUTH,   /* the scene's own clipping surface as a depthmap: no map of this size can be better */
    HS_BESIDE_COUNT
} hs_beside_way;

/* Owned by the caller. */
typedef struct {
    bool exists;
    const hs_cl *cl;
    const hs_plugin *plugin;
    char first_name[64], other_name[64];                   /* "mean", "cost" */
    hs_eval_values first, other;                           /* without the knob */
    hs_eval_knob knob;                                     /* of the studied method */
    uint32_t best;                                         /* HS_BESIDE_KNOB's position */
    hs_measures line[HS_EVAL_MAX_CASES][HS_EVAL_MAX_LINE]; /* over the knob */
    hs_measures of[HS_EVAL_MAX_CASES][HS_BESIDE_COUNT];    /* NAN: not known */
    bool has_confidence[HS_EVAL_MAX_CASES]; /* the other method gave one, and its picture is there */
} hs_eval_beside;

/* Decides whether there is another method: options->beside as "KEY=VALUE[ KEY=VALUE]...", or "none"; NULL:
 * "method=wall", if the plugin has it and options->sets name no method. `cl` and `plugin` must outlive it.
 * HS_ERR_USAGE for settings the plugin does not take. */
bool hs_eval_beside_open(hs_eval_beside *beside, const hs_cl *cl, const hs_plugin *plugin,
                         const hs_eval_options *options, hs_error *err);

/* Measures an open case, of which only hs_eval_case_close may follow. Nothing if there is no other method. */
bool hs_eval_beside_measure(hs_eval_beside *beside, uint32_t index, hs_eval_case *c, hs_error *err);

/* The best knob, when all `count` cases are measured and the mean of their spaces is there. */
void hs_eval_beside_conclude(hs_eval_beside *beside, const hs_eval_mean *mean, const hs_eval_space *spaces,
                             uint32_t count);

/* Mean over the first `count` cases; NAN if one is not known. */
double hs_eval_beside_mean(const hs_eval_beside *beside, uint32_t count, hs_beside_way way,
                           hs_measure measure);

#endif
