/* SPDX-License-Identifier: MIT */
/* One case of the evaluation: a volume with its ground truth, a plugin on it, and the table of its rays. */
#ifndef HS_EVAL_CASE_H
#define HS_EVAL_CASE_H

#include "eval/eval_measure.h"
#include "eval/eval_source.h"
#include "plugin/loader.h"

#define HS_EVAL_MAX_VALUES 64u /* parameter values of a frame */

/* A list of parameter values; a later one for the same parameter counts. */
typedef struct {
    sv_param_value at[HS_EVAL_MAX_VALUES];
    uint32_t count;
} hs_eval_values;

/* Adds a value, in the place of one of the same id. False (HS_ERR_USAGE) if the list is full. */
bool hs_eval_values_add(hs_eval_values *values, uint32_t id, double value, hs_error *err);
/* Adds "key=value" texts; errors name key and value. */
bool hs_eval_values_parse(hs_eval_values *values, const hs_plugin *plugin, const char *const *sets,
                          uint32_t count, hs_error *err);

/* The positions of the plugin's knob (its primary parameter) that are looked at. */
typedef struct {
    bool exists; /* false: the plugin has no knob; then `count` is 1 and `value` means nothing */
    sv_param_info info;
    uint32_t count; /* 1 .. HS_EVAL_MAX_LINE */
    double value[HS_EVAL_MAX_LINE];
} hs_eval_knob;

/* `wanted` positions over the display range, ends included; fewer where its step does not allow more. */
void hs_eval_knob_spread(hs_eval_knob *knob, const hs_plugin *plugin, uint32_t wanted);

/* How the depthmap follows the knob. Decided from the first frame with a surface. */
typedef enum {
    HS_KNOB_UNKNOWN,
    HS_KNOB_LINEAR, /* two maps give all: checked at the last position to 1e-3 slices */
    HS_KNOB_ADJUST, /* the plugin's adjust gives every position */
    HS_KNOB_FRAME   /* a whole frame per position: adjust does not take the knob */
} hs_knob_way;

/* Owned by the caller; must not move while open. */
typedef struct {
    hs_eval_source from;
    hs_loop *loop; /* its picture is as large as the map */
    const hs_plugin *plugin;
    hs_eval_table table;
    hs_knob_way way;
    float *map[2];       /* width * height slices: scratch */
    float *termination;  /* the same in steps */
    uint64_t frame;      /* frames so far */
    double volume_max;   /* 0 .. 1, of the low-resolution volume, as the plugin reports it; 0: it does not */
    uint32_t volume_crc; /* of full volume and ground truth */
} hs_eval_case;

/* Makes or reads the volume, the loop (with `fixed` for the parameters that only activate reads) and the
 * table, and runs the plugin once for volume_max. A plugin that cannot be activated is HS_ERR_PLUGIN here:
 * there is nothing to evaluate. `plugin` may be NULL: then there is the table alone, for maps from
 * elsewhere. */
bool hs_eval_case_open(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin, const hs_eval_values *fixed,
                       const hs_eval_request *request, hs_error *err);
void hs_eval_case_close(hs_eval_case *c);

/* Ends the loop, so that another may use the plugin's instance, which serves one at a time. Then only
 * hs_eval_case_replace and hs_eval_case_close may follow; volume and table stay. */
void hs_eval_case_release(hs_eval_case *c);

/* Puts another plugin on the same volume; the table stays. HS_ERR_PLUGIN if it cannot be activated: then only
 * hs_eval_case_close may follow. */
bool hs_eval_case_replace(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin,
                          const hs_eval_values *fixed, hs_error *err);

/* Measures one setting for every position of the knob. What the plugin does not clip (hs_outcome_clips)
 * is measured unclipped, as the host renders it. *outcome is the plugin's for the first position. */
bool hs_eval_case_measure(hs_eval_case *c, const hs_eval_values *values, const hs_eval_knob *knob,
                          hs_measures *out, sv_status *outcome, hs_error *err);

/* The direct way: the frame with these values, its picture of termination depths (into c->termination) by the
 * renderer, and Eq. 4.5 - 4.10 on that. The depthmap is in c->map[0]; *outcome is the plugin's. */
bool hs_eval_case_direct(hs_eval_case *c, const hs_eval_values *values, hs_measures *out, sv_status *outcome,
                         hs_error *err);

/* Milliseconds from begin until the device has finished after end: the median of
 * `repeats` frames, 1 .. 15. */
bool hs_eval_case_time(hs_eval_case *c, const hs_eval_values *values, uint32_t repeats, double *ms,
                       hs_error *err);

#endif
