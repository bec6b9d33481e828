/* SPDX-License-Identifier: MIT */
/* What the parameter spaces say: the best setting of each case, and the one that is best for all (thesis 5.2,
 * Tables 5.2 and 5.3, Figures 5.7 and 5.8). */
#ifndef HS_EVAL_BEST_H
#define HS_EVAL_BEST_H

#include "eval/eval_space.h"

/* A setting of a space: indices into the plan's axes. */
typedef struct {
    uint32_t threshold, kernel, knob;
} hs_eval_pick;

const hs_measures *hs_eval_at(const hs_eval_space *space, hs_eval_pick pick);

/* The setting with the lowest e_abs; of several equal ones the first. */
hs_eval_pick hs_eval_best(const hs_eval_space *space);

/* The knob with the lowest e_abs where the other two are given. */
hs_eval_pick hs_eval_best_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel);

/* Delta_MI = volume_max - T_B of a position; NAN without a threshold axis. */
double hs_eval_delta(const hs_eval_space *space, uint32_t threshold);

/* The position whose Delta_MI is nearest to `delta`, at most half a step away (0 without a threshold axis);
 * false if the axis does not reach there. */
bool hs_eval_threshold_at(const hs_eval_space *space, double delta, uint32_t *out);

/* e_abs averaged over the cases, for the values of Delta_MI that every case has. */
typedef struct {
    uint32_t deltas;                /* 0: the cases have no Delta_MI in common */
    double delta[HS_EVAL_MAX_LINE]; /* multiples of the threshold's step; NAN without a threshold axis */
    uint32_t kernels, knobs;
    float *e_abs;                          /* [delta][kernel][knob] */
    uint32_t best, best_kernel, best_knob; /* of the lowest average */
} hs_eval_mean;

/* HS_ERR_MEMORY. The spaces share one plan and are whole. */
bool hs_eval_mean_make(hs_eval_mean *mean, const hs_eval_space *spaces, uint32_t count, hs_error *err);
void hs_eval_mean_free(hs_eval_mean *mean);

#endif
