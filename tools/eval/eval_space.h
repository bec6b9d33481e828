/* SPDX-License-Identifier: MIT */
/* The results of a plan on one case; they can be put together from several runs. */
#ifndef HS_EVAL_SPACE_H
#define HS_EVAL_SPACE_H

#include "eval/eval_options.h"
#include "eval/eval_plan.h"

/* The results of one case. Item t * kernel.count + k; result item * knob.count + q. */
typedef struct {
    const hs_eval_plan *plan;
    char name[64];      /* of the case, letters, digits, '-' and '_' only */
    char identity[700]; /* the plan's and the case's */
    double volume_max;  /* 0 .. 1 */
    uint32_t items, done_count;
    uint64_t *seen;     /* bit q: the result is there */
    sv_status *outcome; /* of the plugin, per item */
    hs_measures *at;
} hs_eval_space;

/* Empty results for an open case; `request` goes into the identity. */
bool hs_eval_space_open(hs_eval_space *space, const hs_eval_plan *plan, const hs_eval_case *c,
                        const hs_eval_request *request, hs_error *err);
void hs_eval_space_close(hs_eval_space *space);
bool hs_eval_space_done(const hs_eval_space *space, uint32_t item);

/* Puts the result of one position of the knob where it belongs; items get done as theirs become whole. */
void hs_eval_space_put(hs_eval_space *space, uint32_t item, uint32_t knob, sv_status outcome,
                       const hs_measures *measures);

/* Told of every item as soon as its results are there; false, with an error, ends the run. */
typedef bool (*hs_eval_keep_fn)(void *context, const hs_eval_space *space, uint32_t item, hs_error *err);

/* Runs the shard's items that are not done yet, in their order. */
bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, hs_eval_shard shard, hs_eval_keep_fn keep,
                       void *context, hs_error *err);

#endif
