/* SPDX-License-Identifier: MIT */
#include "eval/eval_study.h"

#include "guarded/guarded.h"
#include "plugin/loader_param.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- thesis -- */

static const hs_eval_thesis_case thesis_cases[] = {
    {"E01", 0.64, 0.23, 19, 0.80, 4.45, 0.80, 4.93}, {"E02", 0.90, 0.02, 63, 0.30, 2.35, 0.00, 6.06},
    {"E03", 0.92, 0.07, 11, 0.95, 6.34, 0.25, 8.24}, {"E04", 0.63, 0.25, 3, 0.75, 4.06, 0.40, 4.58},
    {"M01", 0.74, 0.21, 63, 0.10, 2.39, 0.10, 2.74}, {"M02", 0.58, 0.28, 19, 0.20, 5.84, 0.15, 6.24},
    {"M03", 0.84, 0.04, 3, 0.95, 9.22, 1.20, 10.81}, {"D01", 0.73, 0.20, 47, 0.15, 1.08, 0.15, 1.23},
    {"D02", 0.50, 0.48, 19, 0.85, 2.07, 0.80, 2.82},
};

const hs_eval_thesis_stage hs_eval_thesis_stages[5] = {{"setup", 4.223},
                                                       {"initial points", 0.140},
                                                       {"mean filter", 40.631},
                                                       {"render", 1.335},
                                                       {"total", 46.329}};

const char hs_eval_thesis_note[] =
    "The thesis' numbers stand here to be looked at, not to be beaten: its nine cases are real scans with "
    "ground truths that were segmented by hand, ours are synthetic scenes that reproduce what it says of "
    "them; its depthmap has 512 x 512 pixels, so a kernel of 55 there spans what about 14 span on a map of "
    "128; its step and opacity window are not given, and its frame rates are those of another machine.";

const hs_eval_thesis_case *hs_eval_thesis_find(const char *name) {
    for (size_t i = 0; i < sizeof thesis_cases / sizeof thesis_cases[0]; i++)
        if (strcmp(thesis_cases[i].name, name) == 0) return &thesis_cases[i];
    return NULL;
}

/* ----------------------------------------------------------------------------------------------- speed -- */

#define PIXELS 512u /* per side of the pictures (spec 5) */

bool hs_eval_speed_settings(hs_eval_study *study, uint32_t index, const hs_eval_case *c,
                            const hs_eval_values *values, hs_error *err) {
    hs_eval_result *r = &study->result[index];
    hs_loop_options options;
    if (study->options->frames == 0) return true;
    hs_loop_defaults(&options);
    options.frames = study->options->frames;
    options.lowres = c->table.width;
    options.dvr.width = options.dvr.height = PIXELS;
    options.values = values->at;
    options.value_count = values->count;
    hs_loop *loop = hs_loop_create(&study->cl, &c->from.source, &study->plugin, &options, err);
    bool ok = loop != NULL;
    for (int s = 0; ok && s < HS_SETTING_COUNT; s++)
        ok = hs_loop_run(loop, (hs_setting)s, NULL, &r->speed[s], err);
    r->has_speed = ok;
    hs_loop_destroy(loop);
    return ok;
}

/* ------------------------------------------------------------------------------------------- as it is -- */

#define MAX_REPEATS 15u /* of hs_eval_case_time */

void hs_eval_method_name(const hs_plugin *plugin, const hs_eval_values *values, char *out, uint32_t bytes) {
    sv_param_info info;
    (void)snprintf(out, bytes, "%.60s", plugin->instance->descriptor->id);
    if (!hs_plugin_find_param(plugin, "method", &info)) return;
    double value = info.default_value;
    for (uint32_t i = 0; i < values->count; i++)
        if (values->at[i].id == info.id) value = values->at[i].value;
    hs_plugin_value_text(plugin, &info, value, out, bytes);
}

static bool plain_open(hs_eval_study *study, hs_error *err) {
    hs_eval_plain *const p = &study->plain;
    if (!hs_eval_values_parse(&p->values, &study->plugin, study->options->sets, study->options->set_count,
                              err))
        return false;
    hs_eval_method_name(&study->plugin, &p->values, p->name, sizeof p->name);
    return true;
}

/* The scene's clipping surface as a map of the table's size; files have none. */
static bool measure_truth(const hs_eval_case *c, double *e_abs, hs_error *err) {
    const hs_eval_table *t = &c->table;
    *e_abs = (double)NAN;
    const hs_scene_data *scene = hs_source_scene_data(&c->from.source, 0);
    if (!scene) return true;
    const hs_volume *full = hs_source_volume(&c->from.source, 0);
    const float *clip = scene->clip;
    hs_measures measures;
    float *map = calloc((size_t)t->width * t->height, sizeof *map);
    if (!map) return hs_fail(err, HS_ERR_MEMORY, "true surface: no memory for a map");
    for (uint32_t y = 0; y < t->height; y++)
        for (uint32_t x = 0; x < t->width; x++) {
            /* The column in which the pixel's centre lies: a scene's volume fills the camera's box. */
            const uint32_t column = (uint32_t)((x + 0.5) * full->nx / t->width);
            const uint32_t row = (uint32_t)((y + 0.5) * full->ny / t->height);
            map[(size_t)y * t->width + x] =
                (clip[(size_t)row * full->nx + column] + 0.5f) / t->steps_per_slice - 0.5f;
        }
    hs_eval_measure_map(t, map, &measures);
    *e_abs = (double)measures.of[HS_MEASURE_ABS];
    free(map);
    return true;
}

/* Measures an open case, of which only hs_eval_case_close may follow. */
static bool plain_measure(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    hs_eval_plain *const p = &study->plain;
    const hs_eval_knob none = {.count = 1};
    const uint32_t frames = study->options->frames, repeats = frames < MAX_REPEATS ? frames : MAX_REPEATS;
    p->ms[index] = (double)NAN;
    return measure_truth(c, &p->floor[index], err) &&
           hs_eval_case_replace(c, &study->cl, &study->plugin, &p->values, err) &&
           hs_eval_case_measure(c, &p->values, &none, &p->of[index], &p->outcome[index], err) &&
           (repeats == 0 || hs_eval_case_time(c, &p->values, repeats, &p->ms[index], err));
}

/* ----------------------------------------------------------------------------------------------- study -- */

bool hs_eval_study_open(hs_eval_study *study, const hs_eval_options *options, hs_error *err) {
    char usual[1024];
    *study = (hs_eval_study){.options = options};
    hs_plugin_default_path(usual, sizeof usual);
    const char *path = options->plugin ? options->plugin : usual;
    if (!hs_guarded_open(&study->plugin, path, NULL, SV_LOG_ERROR, &options->guard, err)) return false;
    if (hs_cl_open(&study->cl, err) &&
        hs_eval_plan_make(&study->plan, &study->plugin, options->sets, options->set_count, options->coarse,
                          err) &&
        plain_open(study, err))
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
    return (hs_eval_request){.name = o->cases[index],
                             .size = o->size,
                             .lowres = o->lowres,
                             .seed = o->seed,
                             .real = o->real,
                             .read = o->read};
}

bool hs_eval_study_case(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_request request = request_of(study, index);
    return hs_eval_case_open(c, &study->cl, &study->plugin, &study->plan.base, &request, err);
}

bool hs_eval_study_values(const hs_eval_study *study, hs_eval_setting setting, hs_eval_values *values,
                          hs_error *err) {
    const hs_eval_plan *plan = &study->plan;
    return hs_eval_plan_values(plan, setting.threshold * plan->kernel.count + setting.kernel, values, err) &&
           (!plan->knob.exists ||
            hs_eval_values_add(values, plan->knob.info.id, plan->knob.value[setting.knob], err));
}

/* ---------------------------------------------------------------------------------------------- run -- */

bool hs_eval_study_begin(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    hs_eval_result *result = &study->result[index];
    if (!hs_eval_study_case(study, index, c, err)) return false;
    if (!hs_eval_space_open(&study->space[index], &study->plan, c, err)) {
        hs_eval_case_close(c);
        return false;
    }
    study->count = index + 1;
    hs_eval_measure_map(&c->table, NULL, &result->unclipped);
    (void)snprintf(result->title, sizeof result->title, "%s", c->from.source.title);
    (void)snprintf(result->doubt, sizeof result->doubt, "%s", c->from.doubt);
    return true;
}

bool hs_eval_study_finish(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_error *failure = hs_loop_plugin_error(c->loop);
    if (failure->code != HS_OK) (void)hs_fail(&study->plugin_error, failure->code, "%s", failure->text);
    return plain_measure(study, index, c, err);
}

bool hs_eval_study_conclude(hs_eval_study *study, hs_error *err) {
    if (!hs_eval_mean_make(&study->mean, study->space, study->count, err)) return false;
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
