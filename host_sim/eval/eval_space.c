/* SPDX-License-Identifier: MIT */
#include "eval/eval_space.h"

#include "base/cli.h"
#include "plugin/loader_param.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
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

/* A parameter that the plugin has and the user did not set. */
static bool set_unless_set(hs_eval_plan *plan, const char *key, const char *text, hs_error *err) {
    sv_param_info info;
    if (!hs_plugin_find_param(plan->plugin, key, &info)) return true;
    for (uint32_t i = 0; i < plan->base.count; i++)
        if (plan->base.at[i].id == info.id) return true;
    return hs_eval_values_parse(&plan->base, plan->plugin, &text, 1, err);
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
    if (!hs_eval_values_parse(&plan->base, plugin, sets, count, err) ||
        !set_unless_set(plan, "evidence", "evidence=0", err) || !use_mode_absolute(plan, err))
        return false;
    name_identity(plan, coarse);
    return true;
}

uint32_t hs_eval_plan_items(const hs_eval_plan *plan) {
    return plan->threshold.count * plan->kernel.count;
}

bool hs_eval_space_values(const hs_eval_plan *plan, uint32_t item, hs_eval_values *values, hs_error *err) {
    const uint32_t t = item / plan->kernel.count, k = item % plan->kernel.count;
    *values = plan->base;
    return (!plan->threshold.exists ||
            hs_eval_values_add(values, plan->threshold.id, plan->threshold.value[t], err)) &&
           (!plan->kernel.exists || hs_eval_values_add(values, plan->kernel.id, plan->kernel.value[k], err));
}

bool hs_eval_space_open(hs_eval_space *space, const hs_eval_plan *plan, const hs_eval_case *c,
                        const hs_eval_request *request, hs_error *err) {
    *space = (hs_eval_space){.plan = plan, .volume_max = c->volume_max, .items = hs_eval_plan_items(plan)};
    (void)snprintf(space->name, sizeof space->name, "%.63s", hs_source_volume(&c->from.source, 0)->name);
    for (char *p = space->name; *p; p++)
        if (!isalnum((unsigned char)*p) && *p != '-') *p = '_';
    (void)snprintf(space->identity, sizeof space->identity, "%s; %s size %u lowres %u seed %llu %08x",
                   plan->identity, space->name, request->size, c->table.width,
                   (unsigned long long)request->seed, c->volume_crc);
    if (plan->threshold.exists && !(space->volume_max > 0))
        return hs_fail(err, HS_ERR_PLUGIN,
                       "%s: reports volume_max %g, so Delta_MI = volume_max - T_B cannot "
                       "be told",
                       plan->plugin->path, space->volume_max);
    space->seen = calloc(space->items, sizeof *space->seen);
    space->outcome = calloc(space->items, sizeof *space->outcome);
    space->at = calloc((size_t)space->items * plan->knob.count, sizeof *space->at);
    if (space->seen && space->outcome && space->at) return true;
    hs_eval_space_close(space);
    return hs_fail(err, HS_ERR_MEMORY, "parameter space: no memory");
}

void hs_eval_space_close(hs_eval_space *space) {
    free(space->seen);
    free(space->outcome);
    free(space->at);
    *space = (hs_eval_space){0};
}

bool hs_eval_space_done(const hs_eval_space *space, uint32_t item) {
    const uint32_t positions = space->plan->knob.count;
    return space->seen[item] == (positions < 64 ? (UINT64_C(1) << positions) - 1 : UINT64_MAX);
}

static bool run_item(hs_eval_space *space, hs_eval_case *c, uint32_t item, hs_error *err) {
    hs_eval_values values;
    const uint32_t positions = space->plan->knob.count;
    if (!hs_eval_space_values(space->plan, item, &values, err) ||
        !hs_eval_case_measure(c, &values, &space->plan->knob, space->at + (size_t)item * positions,
                              &space->outcome[item], err))
        return false;
    space->seen[item] = positions < 64 ? (UINT64_C(1) << positions) - 1 : UINT64_MAX;
    space->done_count++;
    return true;
}

static bool run_missing(hs_eval_space *space, hs_eval_case *c, FILE *file, const char *path,
                        hs_eval_shard shard, hs_progress *progress, hs_error *err) {
    const uint32_t mine = (space->items - shard.index + shard.count - 1) / shard.count;
    uint32_t number = 0;
    for (uint32_t item = shard.index; item < space->items; item += shard.count) {
        number++;
        if (hs_eval_space_done(space, item)) continue;
        if (!run_item(space, c, item, err)) return false;
        if (!hs_eval_csv_append(space, item, file))
            return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
        if (progress) hs_progress_step(progress, (uint64_t)number * progress->total / mine);
    }
    return true;
}

bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, const char *folder, hs_eval_shard shard,
                       hs_progress *progress, hs_error *err) {
    char name[128], path[PATH_MAX];
    if (!hs_eval_csv_load(space, folder, err)) return false;
    if (space->done_count < space->items && shard.index < space->items) {
        (void)snprintf(name, sizeof name, "space_%s.part%uof%u.csv", space->name, shard.index + 1,
                       shard.count);
        if (!hs_cli_join(folder, name, path, sizeof path, err) || !hs_eval_csv_write(space, path, err))
            return false;
        FILE *file = fopen(path, "a");
        if (!file) return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
        const bool ok = run_missing(space, c, file, path, shard, progress, err);
        if (fclose(file) != 0 && ok)
            return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
        if (!ok) return false;
    }
    if (space->done_count < space->items) return true;
    (void)snprintf(name, sizeof name, "space_%s.csv", space->name);
    if (!hs_cli_join(folder, name, path, sizeof path, err) || !hs_eval_csv_write(space, path, err))
        return false;
    hs_eval_csv_remove_parts(space, folder);
    return true;
}
