/* SPDX-License-Identifier: MIT */
#include "eval/eval_study.h"

#include "plugin/loader_param.h"
#include "smartvis/lookup.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ------------------------------------------------------------------------------------------------ plan -- */

#define KNOB_POSITIONS 31u
#define COARSE         5u /* every fifth position */

static void fill_axis(hs_eval_axis *axis, double low, double step, uint32_t count, bool coarse) {
    const uint32_t stride = coarse ? COARSE : 1u;
    axis->count = (count - 1u) / stride + 1u;
    axis->step = step * stride;
    /* Plain decimals: 0.57, not 0.5700000000000001. */
    for (uint32_t i = 0; i < axis->count; i++) axis->value[i] = round((low + step * stride * i) * 1e6) / 1e6;
}

/* An axis is there if the plugin has the parameter, and it matters with these values. */
static void find_axis(hs_eval_axis *axis, const hs_plugin *plugin, const char *key,
                      const hs_eval_values *with) {
    sv_param_info info;
    *axis = (hs_eval_axis){.count = 1};
    axis->exists = hs_plugin_find_param(plugin, key, &info) &&
                   sv_lookup_matters(plugin->instance, &info, with->at, with->count);
    if (axis->exists) axis->id = info.id;
}

static bool has_value(const hs_eval_values *values, uint32_t id) {
    for (uint32_t i = 0; i < values->count; i++)
        if (values->at[i].id == id) return true;
    return false;
}

/* What the user set, and where he said nothing what the thesis studies: its filter, method=mean, of a plugin
 * that has it, and any evidence. */
static bool make_base(hs_eval_values *base, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                      hs_error *err) {
    sv_param_info info;
    double mean;
    if (!hs_eval_values_parse(base, plugin, sets, count, err)) return false;
    if (hs_plugin_find_param(plugin, "method", &info) && !has_value(base, info.id) &&
        hs_plugin_find_enum(plugin, &info, "mean", &mean) && !hs_eval_values_add(base, info.id, mean, err))
        return false;
    return !hs_plugin_find_param(plugin, "evidence", &info) || has_value(base, info.id) ||
           hs_eval_values_add(base, info.id, 0.0, err);
}

static bool use_mode_absolute(hs_eval_plan *plan, hs_error *err) {
    const char *const absolute = "bone_mode=absolute";
    sv_param_info info;
    return !hs_plugin_find_param(plan->plugin, "bone_threshold", &info) ||
           !hs_plugin_find_param(plan->plugin, "bone_mode", &info) ||
           hs_eval_values_parse(&plan->base, plan->plugin, &absolute, 1, err);
}

bool hs_eval_plan_make(hs_eval_plan *plan, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       bool coarse, hs_error *err) {
    *plan = (hs_eval_plan){.plugin = plugin};
    if (!make_base(&plan->base, plugin, sets, count, err) || !use_mode_absolute(plan, err)) return false;
    find_axis(&plan->threshold, plugin, "bone_threshold", &plan->base);
    find_axis(&plan->kernel, plugin, "kernel", &plan->base);
    if (plan->threshold.exists) fill_axis(&plan->threshold, 0.5, 0.01, 51, coarse);
    if (plan->kernel.exists) fill_axis(&plan->kernel, 3, 4, 16, coarse);
    hs_eval_knob_spread(&plan->knob, plugin, coarse ? (KNOB_POSITIONS - 1) / COARSE + 1 : KNOB_POSITIONS);
    return true;
}

uint32_t hs_eval_plan_items(const hs_eval_plan *plan) {
    return plan->threshold.count * plan->kernel.count;
}

bool hs_eval_plan_values(const hs_eval_plan *plan, uint32_t item, hs_eval_values *values, hs_error *err) {
    const uint32_t t = item / plan->kernel.count, k = item % plan->kernel.count;
    *values = plan->base;
    return (!plan->threshold.exists ||
            hs_eval_values_add(values, plan->threshold.id, plan->threshold.value[t], err)) &&
           (!plan->kernel.exists || hs_eval_values_add(values, plan->kernel.id, plan->kernel.value[k], err));
}

/* ----------------------------------------------------------------------------------------------- space -- */

bool hs_eval_space_open(hs_eval_space *space, const hs_eval_plan *plan, const hs_eval_case *c,
                        hs_error *err) {
    *space = (hs_eval_space){.plan = plan, .volume_max = c->volume_max, .items = hs_eval_plan_items(plan)};
    (void)snprintf(space->name, sizeof space->name, "%.63s", hs_source_volume(&c->from.source, 0)->name);
    for (char *p = space->name; *p; p++)
        if (!isalnum((unsigned char)*p) && *p != '-') *p = '_';
    if (plan->threshold.exists && !(space->volume_max > 0))
        return hs_fail(err, HS_ERR_PLUGIN,
                       "%s: reports volume_max %g, so Delta_MI = volume_max - T_B cannot be told",
                       plan->plugin->path, space->volume_max);
    space->outcome = calloc(space->items, sizeof *space->outcome);
    space->at = calloc((size_t)space->items * plan->knob.count, sizeof *space->at);
    if (space->outcome && space->at) return true;
    hs_eval_space_close(space);
    return hs_fail(err, HS_ERR_MEMORY, "parameter space: no memory");
}

void hs_eval_space_close(hs_eval_space *space) {
    free(space->outcome);
    free(space->at);
    *space = (hs_eval_space){0};
}

bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, hs_progress *progress, hs_error *err) {
    for (uint32_t item = 0; item < space->items; item++) {
        hs_eval_values values;
        hs_measures *const line = &space->at[(size_t)item * space->plan->knob.count];
        if (!hs_eval_plan_values(space->plan, item, &values, err) ||
            !hs_eval_case_measure(c, &values, &space->plan->knob, line, &space->outcome[item], err))
            return false;
        if (progress) hs_progress_step(progress, item + 1u);
    }
    return true;
}

/* --------------------------------------------------------------------------------------- best settings -- */

const hs_measures *hs_eval_at(const hs_eval_space *space, hs_eval_setting setting) {
    const hs_eval_plan *plan = space->plan;
    const size_t item = (size_t)setting.threshold * plan->kernel.count + setting.kernel;
    return &space->at[item * plan->knob.count + setting.knob];
}

hs_eval_setting hs_eval_best_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel) {
    hs_eval_setting best = {threshold, kernel, 0}, setting = best;
    for (setting.knob = 1; setting.knob < space->plan->knob.count; setting.knob++)
        if (hs_eval_at(space, setting)->of[HS_MEASURE_ABS] < hs_eval_at(space, best)->of[HS_MEASURE_ABS])
            best = setting;
    return best;
}

hs_eval_setting hs_eval_best(const hs_eval_space *space) {
    hs_eval_setting best = {0, 0, 0};
    for (uint32_t t = 0; t < space->plan->threshold.count; t++) {
        for (uint32_t k = 0; k < space->plan->kernel.count; k++) {
            const hs_eval_setting setting = hs_eval_best_knob(space, t, k);
            if (hs_eval_at(space, setting)->of[HS_MEASURE_ABS] < hs_eval_at(space, best)->of[HS_MEASURE_ABS])
                best = setting;
        }
    }
    return best;
}

double hs_eval_delta(const hs_eval_space *space, uint32_t threshold) {
    const hs_eval_axis *axis = &space->plan->threshold;
    return axis->exists ? space->volume_max - axis->value[threshold] : NAN;
}

bool hs_eval_threshold_at(const hs_eval_space *space, double delta, uint32_t *out) {
    const hs_eval_axis *axis = &space->plan->threshold;
    *out = 0;
    if (!axis->exists) return true;
    const double position = (space->volume_max - delta - axis->value[0]) / axis->step;
    const double nearest = floor(position + 0.5);
    if (nearest < 0 || nearest >= axis->count) return false;
    *out = (uint32_t)nearest;
    return true;
}

/* The values of Delta_MI from 0 on that every case has. */
static void find_deltas(hs_eval_mean *mean, const hs_eval_space *spaces, uint32_t count) {
    const hs_eval_axis *axis = &spaces[0].plan->threshold;
    for (uint32_t i = 0; i < HS_EVAL_MAX_LINE; i++) {
        const double delta = i * axis->step;
        uint32_t position, with = 0;
        while (with < count && hs_eval_threshold_at(&spaces[with], delta, &position)) with++;
        if (with == count) mean->delta[mean->deltas++] = axis->exists ? round(delta * 1e6) / 1e6 : NAN;
        if (!axis->exists) return;
    }
}

static float average(const hs_eval_space *spaces, uint32_t count, double delta, uint32_t kernel,
                     uint32_t knob) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        hs_eval_setting setting = {0, kernel, knob};
        (void)hs_eval_threshold_at(&spaces[i], delta, &setting.threshold);
        sum += (double)hs_eval_at(&spaces[i], setting)->of[HS_MEASURE_ABS];
    }
    return (float)(sum / count);
}

bool hs_eval_mean_make(hs_eval_mean *mean, const hs_eval_space *spaces, uint32_t count, hs_error *err) {
    *mean = (hs_eval_mean){.kernels = spaces[0].plan->kernel.count, .knobs = spaces[0].plan->knob.count};
    find_deltas(mean, spaces, count);
    const size_t results = (size_t)mean->deltas * mean->kernels * mean->knobs;
    mean->e_abs = calloc(results + 1, sizeof *mean->e_abs);
    if (!mean->e_abs) return hs_fail(err, HS_ERR_MEMORY, "averages: no memory for %zu settings", results);
    size_t best = 0;
    for (size_t i = 0; i < results; i++) {
        const uint32_t knob = (uint32_t)(i % mean->knobs), rest = (uint32_t)(i / mean->knobs);
        mean->e_abs[i] =
            average(spaces, count, mean->delta[rest / mean->kernels], rest % mean->kernels, knob);
        if (mean->e_abs[i] < mean->e_abs[best]) best = i;
    }
    mean->best_knob = (uint32_t)(best % mean->knobs);
    mean->best_kernel = (uint32_t)(best / mean->knobs % mean->kernels);
    mean->best = (uint32_t)(best / mean->knobs / mean->kernels);
    return true;
}

void hs_eval_mean_free(hs_eval_mean *mean) {
    free(mean->e_abs);
    *mean = (hs_eval_mean){0};
}
