/* SPDX-License-Identifier: MIT */
#include "eval/eval_space.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>

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
                       "%s: reports volume_max %g, so Delta_MI = volume_max - T_B cannot be told",
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

void hs_eval_space_put(hs_eval_space *space, uint32_t item, uint32_t knob, sv_status outcome,
                       const hs_measures *measures) {
    const bool before = hs_eval_space_done(space, item);
    space->outcome[item] = outcome;
    space->at[(size_t)item * space->plan->knob.count + knob] = *measures;
    space->seen[item] |= UINT64_C(1) << knob;
    if (!before && hs_eval_space_done(space, item)) space->done_count++;
}

static bool run_item(hs_eval_space *space, hs_eval_case *c, uint32_t item, hs_error *err) {
    hs_eval_values values;
    hs_measures line[HS_EVAL_MAX_LINE];
    sv_status outcome;
    if (!hs_eval_plan_values(space->plan, item, &values, err) ||
        !hs_eval_case_measure(c, &values, &space->plan->knob, line, &outcome, err))
        return false;
    for (uint32_t k = 0; k < space->plan->knob.count; k++)
        hs_eval_space_put(space, item, k, outcome, &line[k]);
    return true;
}

bool hs_eval_space_run(hs_eval_space *space, hs_eval_case *c, hs_eval_shard shard, hs_eval_keep_fn keep,
                       void *context, hs_error *err) {
    for (uint32_t item = shard.index; item < space->items; item += shard.count)
        if (!hs_eval_space_done(space, item) &&
            (!run_item(space, c, item, err) || !keep(context, space, item, err)))
            return false;
    return true;
}
