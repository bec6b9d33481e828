/* SPDX-License-Identifier: MIT */
#include "eval/eval_plan.h"

#include "plugin/loader_param.h"

#include <math.h>
#include <stdio.h>
#include <zlib.h>

#define KNOB_POSITIONS 31u
#define COARSE         5u /* every fifth position */

static void fill_axis(hs_eval_axis *axis, double low, double step, uint32_t count, bool coarse) {
    const uint32_t stride = coarse ? COARSE : 1u;
    axis->count = (count - 1u) / stride + 1u;
    axis->step = step * stride;
    /* Plain decimals: 0.57, not 0.5700000000000001. */
    for (uint32_t i = 0; i < axis->count; i++) axis->value[i] = round((low + step * stride * i) * 1e6) / 1e6;
}

static void find_axis(hs_eval_axis *axis, const hs_plugin *plugin, const char *key) {
    sv_param_info info;
    *axis = (hs_eval_axis){.count = 1};
    axis->exists = hs_plugin_find_param(plugin, key, &info);
    if (axis->exists) axis->id = info.id;
}

static bool has_value(const hs_eval_values *values, uint32_t id) {
    for (uint32_t i = 0; i < values->count; i++)
        if (values->at[i].id == id) return true;
    return false;
}

bool hs_eval_plan_base(hs_eval_values *base, const hs_plugin *plugin, const char *const *sets, uint32_t count,
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

static uint32_t file_crc(const char *path) {
    unsigned char block[16384];
    uLong crc = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    for (size_t got; (got = fread(block, 1, sizeof block, file)) > 0;) crc = crc32_z(crc, block, got);
    (void)fclose(file);
    return (uint32_t)crc;
}

static void name_identity(hs_eval_plan *plan, bool coarse) {
    const sv_descriptor *d = plan->plugin->instance->descriptor;
    int length = snprintf(plan->identity, sizeof plan->identity, "%.100s %.40s %08x%s", d->id, d->version,
                          file_crc(plan->plugin->path), coarse ? " coarse" : "");
    for (uint32_t i = 0; i < plan->base.count && length < (int)sizeof plan->identity; i++)
        length += snprintf(plan->identity + length, sizeof plan->identity - (size_t)length, " %u=%.6g",
                           plan->base.at[i].id, plan->base.at[i].value);
}

static bool use_mode_absolute(hs_eval_plan *plan, hs_error *err) {
    const char *const absolute = "bone_mode=absolute";
    sv_param_info info;
    return !plan->threshold.exists || !hs_plugin_find_param(plan->plugin, "bone_mode", &info) ||
           hs_eval_values_parse(&plan->base, plan->plugin, &absolute, 1, err);
}

bool hs_eval_plan_make(hs_eval_plan *plan, const hs_plugin *plugin, const char *const *sets, uint32_t count,
                       bool coarse, hs_error *err) {
    *plan = (hs_eval_plan){.plugin = plugin};
    find_axis(&plan->threshold, plugin, "bone_threshold");
    find_axis(&plan->kernel, plugin, "kernel");
    if (plan->threshold.exists) fill_axis(&plan->threshold, 0.5, 0.01, 51, coarse);
    if (plan->kernel.exists) fill_axis(&plan->kernel, 3, 4, 16, coarse);
    hs_eval_knob_spread(&plan->knob, plugin, coarse ? (KNOB_POSITIONS - 1) / COARSE + 1 : KNOB_POSITIONS);
    if (!hs_eval_plan_base(&plan->base, plugin, sets, count, err) || !use_mode_absolute(plan, err))
        return false;
    name_identity(plan, coarse);
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
