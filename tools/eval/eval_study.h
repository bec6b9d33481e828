/* SPDX-License-Identifier: MIT */
/* A whole study: the cases of `host_sim report`, their parameter spaces, and what came of them. */
#ifndef HS_EVAL_STUDY_H
#define HS_EVAL_STUDY_H

#include "eval/eval_beside.h"
#include "eval/eval_best.h"
#include "eval/eval_options.h"
#include "loop/loop_run.h"

#define HS_EVAL_TURNS  7u /* positions of the slider */
#define HS_EVAL_CURVES 5u /* thresholds of Figure 5.20 */

/* What is known of a case when its space is whole, and its page's pictures are made. */
typedef struct {
    char title[256];         /* what the thesis says of it */
    hs_measures unclipped;   /* of the full volume */
    hs_eval_pick best;       /* Table 5.2 */
    hs_eval_pick common;     /* Table 5.3: the common setting, the case's best knob */
    hs_measures shown;       /* measured the direct way at `common` */
    sv_status shown_outcome; /* of the plugin there */
    uint32_t turns;          /* pictures of the knob: 0 if it cannot be turned */
    double turn[HS_EVAL_TURNS];
    uint32_t turned; /* the one nearest to `common` */
    bool has_speed;
    hs_loop_result speed[HS_SETTING_COUNT];
} hs_eval_result;

/* Owned by the caller; must not move while open. */
typedef struct hs_eval_study {
    const hs_eval_options *options;
    hs_cl cl;
    hs_plugin plugin;
    hs_eval_plan plan;
    uint32_t count;
    hs_eval_space space[HS_EVAL_MAX_CASES];
    hs_eval_result result[HS_EVAL_MAX_CASES];
    hs_eval_mean mean;
    hs_eval_beside beside; /* another method of the plugin */
    uint32_t curves;       /* Figure 5.20; 0: not measured */
    double curve_threshold[HS_EVAL_CURVES];
    double curve_fps[HS_EVAL_CURVES][HS_EVAL_MAX_LINE]; /* by kernel: frames of the plugin a second */
    char curve_case[64];
    double check_worst[3]; /* steps: largest difference of e_abs, e_pos, e_neg to the direct way */
    uint32_t checked;
    hs_error plugin_error; /* the plugin's first failure */
} hs_eval_study;

/* Device, plugin, plan. On failure everything is freed. */
bool hs_eval_study_open(hs_eval_study *study, const hs_eval_options *options, hs_error *err);
/* False with HS_ERR_PLUGIN if a guarded plugin ended before it was to. */
bool hs_eval_study_close(hs_eval_study *study, hs_error *err);

/* Opens case `index` with its plugin, for measures and pictures: HS_ERR_INPUT, HS_ERR_PLUGIN, HS_ERR_DEVICE
 * or HS_ERR_MEMORY. End it with hs_eval_case_close. */
bool hs_eval_study_case(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);

/*
 * Cases are measured in their order, each in three steps. Begin opens the case, and its space without
 * results. Then the caller fills the space: from files, by hs_eval_space_run, or both. Finish measures this
 * case's share of options->check the direct way, keeps the plugin's first failure, and measures the other
 * method unless this is a shard; only hs_eval_case_close may follow. If begin fails the case is closed.
 */
bool hs_eval_study_begin(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);
bool hs_eval_study_finish(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);

/* All settings of all cases are there. */
bool hs_eval_study_whole(const hs_eval_study *study);

/* Best and common settings; the spaces must be whole. HS_ERR_MEMORY. */
bool hs_eval_study_conclude(hs_eval_study *study, hs_error *err);

/* The values of a setting, the knob included. */
bool hs_eval_study_values(const hs_eval_study *study, hs_eval_pick pick, hs_eval_values *values,
                          hs_error *err);

#endif
