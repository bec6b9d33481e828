/* SPDX-License-Identifier: MIT */
/* The parameter space of a plugin on one case (thesis, Table 5.1), kept in CSV files that can be resumed and
 * put together from shards. */
#ifndef HS_EVAL_SPACE_H
#define HS_EVAL_SPACE_H

#include "eval/eval_case.h"

#include <stdio.h>

/* A parameter that is swept. An axis the plugin does not have holds one position and sets nothing. */
typedef struct {
    bool exists;
    uint32_t id;
    uint32_t count; /* 1 .. HS_EVAL_MAX_LINE */
    double step;
    double value[HS_EVAL_MAX_LINE];
} hs_eval_axis;

/* What is swept for a plugin. */
typedef struct {
    const hs_plugin *plugin;
    hs_eval_values base;    /* what the user set, and the thesis' rule: absolute threshold, any evidence */
    hs_eval_axis threshold; /* T_B, "bone_threshold" in mode absolute: 0.5 .. 1 by 0.01 */
    hs_eval_axis kernel;    /* k, "kernel": 3 .. 63 by 4 */
    hs_eval_knob knob;      /* q: 0 .. 1.5 by 0.05, or 31 positions of another knob */
    char identity[512];     /* plugin, its file's checksum, what was set: which results may be mixed */
} hs_eval_plan;

/* `coarse` takes every fifth position of the three axes. */
bool hs_eval_plan_make(hs_eval_plan *plan, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       bool coarse, hs_error *err);

/* Settings without the knob: one frame each. */
uint32_t hs_eval_plan_items(const hs_eval_plan *plan);

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

/* Shard `index` (0 .. count - 1) of `count` takes every count-th setting; 0 of 1 takes all. */
typedef struct {
    uint32_t index, count;
} hs_eval_shard;

/*
 * Runs what the shard has to run and no file in `folder` holds yet. Results go to
 * "space_<case>.part<i>of<n>.csv" as they come, so that a run that was ended goes on where it stopped; once a
 * case is whole, to "space_<case>.csv". `progress` may be NULL.
 */
bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, const char *folder, hs_eval_shard shard,
                       hs_progress *progress, hs_error *err);

/* The values of an item, and its T_B and k. */
bool hs_eval_space_values(const hs_eval_plan *plan, uint32_t item, hs_eval_values *values, hs_error *err);

/* ------------------------------------------------------------------------------------------ CSV files -- */

/* Reads every "space_<case>*.csv" of the folder. A last line that is cut off does not count. HS_ERR_INPUT: a
 * file of another identity, or a line that is no result, named with its number. */
bool hs_eval_csv_load(hs_eval_space *space, const char *folder, hs_error *err);

/* Writes all results so far to `path`, which appears whole. */
bool hs_eval_csv_write(const hs_eval_space *space, const char *path, hs_error *err);

/* Appends the rows of one item. */
bool hs_eval_csv_append(const hs_eval_space *space, uint32_t item, FILE *file);

/* Removes the files of parts: their results are in "space_<case>.csv" now. */
void hs_eval_csv_remove_parts(const hs_eval_space *space, const char *folder);

#endif
