/* SPDX-License-Identifier: MIT */
/* A plugin over all cases: as it is, and its parameter space: what is run and what is best. */
#pragma once

#include "core/progress.h"
#include "eval/eval_case.h"
#include "guarded/guard_options.h"
#include "loop/loop_run.h"
#include "render/dvr_settings.h"

/* --------------------------------------------------------------------------------------------- options -- */
/* What is asked of an evaluation. */

#define HS_EVAL_MAX_CASES 32u
#define HS_EVAL_MAX_SETS  32u

/* What the command line asks for. Strings are borrowed. */
typedef struct {
    const char *out;        /* folder */
    const char *plugin;     /* NULL: smartvis.so beside the executable */
    hs_guard_options guard; /* of every plugin */
    const char *cases[HS_EVAL_MAX_CASES];
    uint32_t case_count;
    const char *sets[HS_EVAL_MAX_SETS]; /* key=value */
    uint32_t set_count;
    uint32_t size, lowres;
    uint64_t seed;
    const char *real;                       /* the volume of the scene "real"; NULL: none */
    hs_metaimage_options read;              /* how files are read */
    bool coarse;                            /* a fifth of the positions on every axis */
    uint32_t frames;                        /* of a measurement of speed; 0: none */
    const char *compare[HS_EVAL_MAX_CASES]; /* "library[ key=value]..." */
    uint32_t compare_count;
    uint32_t seeds; /* of a comparison */
    hs_look look;   /* of pictures; measures use the thesis' */
    float light[2]; /* hs_dvr_settings */
} hs_eval_options;

/* ---------------------------------------------------------------------------------------------- thesis -- */
/* What the thesis measured, to stand beside our own numbers: facts from Tables 5.2, 5.3 and 5.4. */

/* One case. Errors in DVR steps of the thesis' renderer. Its e_pos and e_neg contradict e_abs in several rows
 * (spec 9), so only e_abs is kept. */
typedef struct {
    const char *name;
    double threshold, delta, kernel, knob, e_abs; /* Table 5.2: T_B, Delta_MI, k, q */
    double common_knob, common_e_abs;             /* Table 5.3: Delta_MI 0.24, k 55 */
} hs_eval_thesis_case;

/* NULL if the thesis has no such case. */
const hs_eval_thesis_case *hs_eval_thesis_find(const char *name);

/* Table 5.4, milliseconds: the average over the cases. */
typedef struct {
    const char *stage;
    double ms;
} hs_eval_thesis_stage;
extern const hs_eval_thesis_stage hs_eval_thesis_stages[5];

/* Frames a second that the plugin costs on average (thesis 5.4, on Figure 5.21). */
#define HS_EVAL_THESIS_LOST_FPS 6

/* Why the numbers cannot be compared one by one. */
extern const char hs_eval_thesis_note[];

/* ------------------------------------------------------------------------------------------------ plan -- */
/* Which settings of a plugin are measured (thesis, Table 5.1). */

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
    hs_eval_values base;    /* what the user set, method=mean, any evidence, an absolute threshold */
    hs_eval_axis threshold; /* T_B, "bone_threshold" in mode absolute: 0.5 .. 1 by 0.01 */
    hs_eval_axis kernel;    /* k, "kernel": 3 .. 63 by 4 */
    hs_eval_knob knob;      /* q: 0 .. 1.5 by 0.05, or 31 positions of another knob */
} hs_eval_plan;

/* `coarse` takes every fifth position of the three axes. */
bool hs_eval_plan_make(hs_eval_plan *plan, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       bool coarse, hs_error *err);

/* Settings without the knob: one frame each. */
uint32_t hs_eval_plan_items(const hs_eval_plan *plan);

/* The values of an item, its T_B and k among them. */
bool hs_eval_plan_values(const hs_eval_plan *plan, uint32_t item, hs_eval_values *values, hs_error *err);

/* ----------------------------------------------------------------------------------------------- space -- */
/* The results of a plan on one case. */

/* The results of one case. Item t * kernel.count + k; result item * knob.count + q. */
typedef struct {
    const hs_eval_plan *plan;
    char name[64];     /* of the case, letters, digits, '-' and '_' only */
    double volume_max; /* 0 .. 1 */
    uint32_t items;
    sv_status *outcome; /* of the plugin, per item */
    hs_measures *at;
} hs_eval_space;

/* Empty results for an open case. */
bool hs_eval_space_open(hs_eval_space *space, const hs_eval_plan *plan, const hs_eval_case *c, hs_error *err);
void hs_eval_space_close(hs_eval_space *space);

/* Runs all items, in their order. `progress` may be NULL. */
bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, hs_progress *progress, hs_error *err);

/* --------------------------------------------------------------------------------------- best settings -- */
/* What the parameter spaces say: the best setting of each case, and the one that is best for all (thesis 5.2,
 * Tables 5.2 and 5.3, Figures 5.7 and 5.8). */

/* A setting of a space: indices into the plan's axes. */
typedef struct {
    uint32_t threshold, kernel, knob;
} hs_eval_setting;

const hs_measures *hs_eval_at(const hs_eval_space *space, hs_eval_setting setting);

/* The setting with the lowest e_abs; of several equal ones the first. */
hs_eval_setting hs_eval_best(const hs_eval_space *space);

/* The knob with the lowest e_abs where the other two are given. */
hs_eval_setting hs_eval_best_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel);

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

/* ------------------------------------------------------------------------------------------- as it is -- */
/* The plugin as a user gets it: what he set, defaults for the rest, nothing chosen by the truth. */

typedef struct {
    char name[64];         /* hs_eval_method_name */
    hs_eval_values values; /* what the user set */
    hs_measures of[HS_EVAL_MAX_CASES];
    sv_status outcome[HS_EVAL_MAX_CASES];
    double ms[HS_EVAL_MAX_CASES];    /* hs_eval_case_time; NAN: not measured */
    double floor[HS_EVAL_MAX_CASES]; /* e_abs of the scene's own clipping surface as a depthmap: no map of
                                      * this size can be better; NAN: files have none */
} hs_eval_plain;

/* The value of the plugin's parameter "method" with these values; without one the plugin's id. */
void hs_eval_method_name(const hs_plugin *plugin, const hs_eval_values *values, char *out, uint32_t bytes);

/* ----------------------------------------------------------------------------------------------- study -- */
/* A whole study: the cases of `host_sim report`, their parameter spaces, and what came of them. */

#define HS_EVAL_TURNS 7u /* positions of the slider */

/* What is known of a case when its space is whole, and its page's pictures are made. */
typedef struct {
    char title[256];         /* what the thesis says of it */
    hs_measures unclipped;   /* of the full volume */
    hs_eval_setting best;    /* Table 5.2 */
    hs_eval_setting common;  /* Table 5.3: the common setting, the case's best knob */
    hs_measures shown;       /* measured the direct way at `common` */
    sv_status shown_outcome; /* of the plugin there */
    bool truth_cut;          /* the truth's picture shows a cut (hs_truth_shows_cut) */
    bool sure;               /* the plugin gave a confidence, and its picture is there */
    char doubt[400];         /* hs_eval_source */
    bool has_reference;      /* there is a picture of it */
    char note[200];          /* of the plain result: why it is not clipped, or not all of it; "": it is */
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
    hs_eval_plain plain;
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
 * results. Then the caller fills the space by hs_eval_space_run. Finish keeps the plugin's first failure, and
 * measures the plugin as it is; only hs_eval_case_close may follow. If begin fails the case is closed.
 */
bool hs_eval_study_begin(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);
bool hs_eval_study_finish(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err);

/* Best and common settings; the spaces must be whole. HS_ERR_MEMORY. */
bool hs_eval_study_conclude(hs_eval_study *study, hs_error *err);

/* The values of a setting, the knob included. */
bool hs_eval_study_values(const hs_eval_study *study, hs_eval_setting setting, hs_eval_values *values,
                          hs_error *err);

/* ----------------------------------------------------------------------------------------------- speed -- */
/* How fast a plugin is on the cases of a study, by the wall clock (thesis 5.4, Figure 5.21). */

/* Figure 5.21 and Table 5.4, into the case's result: options->frames frames (0: nothing) of the three
 * settings with `values`, pictures of 512 x 512. The case must be released (hs_eval_case_release). */
bool hs_eval_speed_settings(hs_eval_study *study, uint32_t index, const hs_eval_case *c,
                            const hs_eval_values *values, hs_error *err);
