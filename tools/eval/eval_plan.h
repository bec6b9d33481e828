/* SPDX-License-Identifier: MIT */
/* Which settings of a plugin are measured (thesis, Table 5.1). */
#ifndef HS_EVAL_PLAN_H
#define HS_EVAL_PLAN_H

#include "eval/eval_case.h"

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
    hs_eval_values base;    /* hs_eval_plan_base, and an absolute threshold */
    hs_eval_axis threshold; /* T_B, "bone_threshold" in mode absolute: 0.5 .. 1 by 0.01 */
    hs_eval_axis kernel;    /* k, "kernel": 3 .. 63 by 4 */
    hs_eval_knob knob;      /* q: 0 .. 1.5 by 0.05, or 31 positions of another knob */
    char identity[512];     /* plugin, its file's checksum, what was set: which results may be mixed */
} hs_eval_plan;

/* What the user set, and where he said nothing what the thesis studies: its filter, method=mean, of a plugin
 * that has it, and any evidence. */
bool hs_eval_plan_base(hs_eval_values *base, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       hs_error *err);

/* `coarse` takes every fifth position of the three axes. */
bool hs_eval_plan_make(hs_eval_plan *plan, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       bool coarse, hs_error *err);

/* Settings without the knob: one frame each. */
uint32_t hs_eval_plan_items(const hs_eval_plan *plan);

/* The values of an item, its T_B and k among them. */
bool hs_eval_plan_values(const hs_eval_plan *plan, uint32_t item, hs_eval_values *values, hs_error *err);

#endif
