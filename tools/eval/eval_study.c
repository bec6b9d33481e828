/* SPDX-License-Identifier: MIT */
#include "eval/eval_study.h"

#include "guarded/guarded.h"

#include <math.h>
#include <stdio.h>

bool hs_eval_study_open(hs_eval_study *study, const hs_eval_options *options, hs_error *err) {
    char beside[1024];
    *study = (hs_eval_study){.options = options};
    hs_plugin_default_path(beside, sizeof beside);
    const char *path = options->plugin ? options->plugin : beside;
    if (!hs_guarded_open(&study->plugin, path, NULL, SV_LOG_ERROR, &options->guard, err)) return false;
    if (hs_cl_open(&study->cl, err) &&
        hs_eval_plan_make(&study->plan, &study->plugin, options->sets, options->set_count, options->coarse,
                          err) &&
        hs_eval_beside_open(&study->beside, &study->cl, &study->plugin, options, err))
        return true;
    (void)hs_eval_study_close(study, err);
    return false;
}

bool hs_eval_study_close(hs_eval_study *study, hs_error *err) {
    bool ok = true;
    for (uint32_t i = 0; i < study->count; i++) hs_eval_space_close(&study->space[i]);
    hs_eval_mean_free(&study->mean);
    if (study->plugin.instance) ok = hs_guarded_close(&study->plugin, err);
    hs_cl_close(&study->cl);
    *study = (hs_eval_study){0};
    return ok;
}

static hs_eval_request request_of(const hs_eval_study *study, uint32_t index) {
    const hs_eval_options *o = study->options;
    return (hs_eval_request){
        .name = o->cases[index], .size = o->size, .lowres = o->lowres, .seed = o->seed, .real = o->real};
}

bool hs_eval_study_case(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_request request = request_of(study, index);
    return hs_eval_case_open(c, &study->cl, &study->plugin, &study->plan.base, &request, err);
}

bool hs_eval_study_values(const hs_eval_study *study, hs_eval_pick pick, hs_eval_values *values,
                          hs_error *err) {
    const hs_eval_plan *plan = &study->plan;
    return hs_eval_plan_values(plan, pick.threshold * plan->kernel.count + pick.kernel, values, err) &&
           (!plan->knob.exists ||
            hs_eval_values_add(values, plan->knob.info.id, plan->knob.value[pick.knob], err));
}

/* ------------------------------------------------------------------------------------- direct check -- */

/* A linear congruential generator (Numerical Recipes' constants): the same settings on every machine. */
static uint32_t next_random(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static bool check_setting(hs_eval_study *study, const hs_eval_space *space, hs_eval_case *c,
                          hs_eval_pick pick, hs_error *err) {
    hs_eval_values values;
    hs_measures direct;
    sv_status outcome;
    if (!hs_eval_study_values(study, pick, &values, err) ||
        !hs_eval_case_direct(c, &values, &direct, &outcome, err))
        return false;
    for (int m = 0; m < 3; m++) {
        const double a = (double)hs_eval_at(space, pick)->of[m], b = (double)direct.of[m];
        const double off = isnan(a) && isnan(b) ? 0.0 : fabs(a - b);
        if (!(off <= study->check_worst[m])) study->check_worst[m] = off;
    }
    study->checked++;
    return true;
}

/* This case's share of the settings that --check asks for, among those that are there. */
static bool check_case(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_space *space = &study->space[index];
    const hs_eval_plan *plan = &study->plan;
    const uint32_t cases = study->options->case_count;
    const uint32_t wanted = study->options->check / cases + (index < study->options->check % cases);
    uint32_t state = index + 1u;
    for (uint32_t n = 0; n < wanted && space->done_count > 0;) {
        const hs_eval_pick pick = {next_random(&state) % plan->threshold.count,
                                   next_random(&state) % plan->kernel.count,
                                   next_random(&state) % plan->knob.count};
        if (!hs_eval_space_done(space, pick.threshold * plan->kernel.count + pick.kernel)) continue;
        if (!check_setting(study, space, c, pick, err)) return false;
        n++;
    }
    return true;
}

/* ---------------------------------------------------------------------------------------------- run -- */

bool hs_eval_study_begin(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_request request = request_of(study, index);
    hs_eval_result *result = &study->result[index];
    if (!hs_eval_study_case(study, index, c, err)) return false;
    if (!hs_eval_space_open(&study->space[index], &study->plan, c, &request, err)) {
        hs_eval_case_close(c);
        return false;
    }
    study->count = index + 1;
    hs_eval_measure_map(&c->table, NULL, &result->unclipped);
    (void)snprintf(result->title, sizeof result->title, "%s", c->from.source.title);
    return true;
}

bool hs_eval_study_finish(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    if (!check_case(study, index, c, err)) return false;
    const hs_error *failure = hs_loop_plugin_error(c->loop);
    if (failure->code != HS_OK) (void)hs_fail(&study->plugin_error, failure->code, "%s", failure->text);
    /* A shard is only a part of what the methods are compared by. */
    return study->options->shard.count > 1 || hs_eval_beside_measure(&study->beside, index, c, err);
}

bool hs_eval_study_whole(const hs_eval_study *study) {
    for (uint32_t i = 0; i < study->count; i++)
        if (study->space[i].done_count < study->space[i].items) return false;
    return study->count == study->options->case_count;
}

bool hs_eval_study_conclude(hs_eval_study *study, hs_error *err) {
    if (!hs_eval_mean_make(&study->mean, study->space, study->count, err)) return false;
    hs_eval_beside_conclude(&study->beside, &study->mean, study->space, study->count);
    for (uint32_t i = 0; i < study->count; i++) {
        const hs_eval_space *space = &study->space[i];
        hs_eval_result *r = &study->result[i];
        r->best = r->common = hs_eval_best(space);
        uint32_t threshold;
        /* Cases without a common Delta_MI keep their own best. */
        if (study->mean.deltas > 0 &&
            hs_eval_threshold_at(space, study->mean.delta[study->mean.best], &threshold))
            r->common = hs_eval_best_knob(space, threshold, study->mean.best_kernel);
    }
    return true;
}
