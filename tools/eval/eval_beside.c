/* SPDX-License-Identifier: MIT */
#include "eval/eval_beside.h"

#include "eval/eval_plan.h"
#include "plugin/loader_param.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define USUAL     "method=wall" /* what is set beside where nothing is said */
#define POSITIONS 31u           /* of the knob */

/* Adds "KEY=VALUE[ KEY=VALUE]...". */
static bool parse(hs_eval_values *values, const hs_plugin *plugin, const char *text, hs_error *err) {
    char copy[256];
    char *next = NULL;
    if (strlen(text) >= sizeof copy)
        return hs_fail(err, HS_ERR_USAGE, "--beside: longer than %zu characters", sizeof copy - 1);
    (void)snprintf(copy, sizeof copy, "%s", text);
    const char *set = strtok_r(copy, " ", &next);
    for (; set; set = strtok_r(NULL, " ", &next))
        if (!hs_eval_values_parse(values, plugin, &set, 1, err)) return false;
    return true;
}

static bool names_a_method(const hs_eval_options *o) {
    for (uint32_t i = 0; i < o->set_count; i++)
        if (strncmp(o->sets[i], "method=", strlen("method=")) == 0) return true;
    return false;
}

/* The value text of the parameter "method" among the values, or what `otherwise` says. */
static void name_method(const hs_plugin *plugin, const hs_eval_values *values, const char *otherwise,
                        char *out, uint32_t bytes) {
    sv_param_info info;
    (void)snprintf(out, bytes, "%.63s", otherwise);
    if (!hs_plugin_find_param(plugin, "method", &info)) return;
    double value = info.default_value;
    for (uint32_t i = 0; i < values->count; i++)
        if (values->at[i].id == info.id) value = values->at[i].value;
    hs_plugin_value_text(plugin, &info, value, out, bytes);
}

bool hs_eval_beside_open(hs_eval_beside *b, const hs_cl *cl, const hs_plugin *plugin,
                         const hs_eval_options *options, hs_error *err) {
    const char *wanted = options->beside;
    hs_error ignored = {0};
    *b = (hs_eval_beside){.cl = cl, .plugin = plugin};
    if (wanted && strcmp(wanted, "none") == 0) return true;
    if (!wanted && names_a_method(options)) return true;
    if (!hs_eval_plan_base(&b->first, plugin, options->sets, options->set_count, err)) return false;
    b->other = b->first;
    if (!wanted && !parse(&b->other, plugin, USUAL, &ignored)) return true;
    if (wanted && !parse(&b->other, plugin, wanted, err)) return false;
    name_method(plugin, &b->first, "as set", b->first_name, sizeof b->first_name);
    name_method(plugin, &b->other, wanted ? wanted : USUAL, b->other_name, sizeof b->other_name);
    if (strcmp(b->first_name, b->other_name) == 0)
        (void)snprintf(b->other_name, sizeof b->other_name, "%.63s", wanted ? wanted : USUAL);
    hs_eval_knob_spread(&b->knob, plugin, POSITIONS);
    b->exists = true;
    return true;
}

/* -------------------------------------------------------------------------------------------- measure -- */

static hs_measures unknown(void) {
    hs_measures m;
    for (int i = 0; i < HS_MEASURE_COUNT; i++) m.of[i] = NAN;
    return m;
}

/* The scene's clipping surface as a map of the table's size; files have none. */
static bool measure_truth(const hs_eval_case *c, hs_measures *out, hs_error *err) {
    const hs_eval_table *t = &c->table;
    *out = unknown();
    const hs_scene_data *scene = hs_source_scene_data(&c->from.source, 0);
    if (!scene) return true;
    const hs_volume *full = hs_source_volume(&c->from.source, 0);
    const float *clip = scene->clip;
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
    hs_eval_measure_map(t, map, out);
    free(map);
    return true;
}

/* The method at the defaults of its knob. */
static bool measure_plain(hs_eval_case *c, const hs_eval_values *values, hs_measures *out, hs_error *err) {
    const hs_eval_knob none = {.count = 1};
    sv_status outcome;
    return hs_eval_case_measure(c, values, &none, out, &outcome, err);
}

bool hs_eval_beside_measure(hs_eval_beside *b, uint32_t index, hs_eval_case *c, hs_error *err) {
    sv_status outcome;
    if (!b->exists) return true;
    hs_measures *of = b->of[index];
    if (!measure_truth(c, &of[HS_BESIDE_TRUTH], err) ||
        !measure_plain(c, &b->first, &of[HS_BESIDE_DEFAULT], err))
        return false;
    c->way = HS_KNOB_UNKNOWN;
    return hs_eval_case_measure(c, &b->first, &b->knob, b->line[index], &outcome, err) &&
           hs_eval_case_replace(c, b->cl, b->plugin, &b->other, err) &&
           measure_plain(c, &b->other, &of[HS_BESIDE_OTHER], err);
}

/* ------------------------------------------------------------------------------------------- conclude -- */

/* The whole space's common setting with one knob for all; unknown if the cases have none. */
static hs_measures tuned(const hs_eval_mean *mean, const hs_eval_space *space) {
    hs_eval_pick pick = {0, mean->best_kernel, mean->best_knob};
    if (mean->deltas == 0 || !hs_eval_threshold_at(space, mean->delta[mean->best], &pick.threshold))
        return unknown();
    return *hs_eval_at(space, pick);
}

void hs_eval_beside_conclude(hs_eval_beside *b, const hs_eval_mean *mean, const hs_eval_space *spaces,
                             uint32_t count) {
    double lowest = INFINITY;
    if (!b->exists) return;
    for (uint32_t k = 0; k < b->knob.count; k++) {
        double sum = 0;
        for (uint32_t i = 0; i < count; i++) sum += (double)b->line[i][k].of[HS_MEASURE_ABS];
        if (sum >= lowest) continue;
        lowest = sum;
        b->best = k;
    }
    for (uint32_t i = 0; i < count; i++) {
        b->of[i][HS_BESIDE_KNOB] = b->line[i][b->best];
        b->of[i][HS_BESIDE_TUNED] = tuned(mean, &spaces[i]);
    }
}

double hs_eval_beside_mean(const hs_eval_beside *beside, uint32_t count, hs_beside_way way,
                           hs_measure measure) {
    double sum = 0;
    uint32_t known = 0; /* a case without a fetus has nothing of one that is cut */
    for (uint32_t i = 0; i < count; i++) known += isnan(beside->of[i][way].of[measure]) ? 0 : 1;
    for (uint32_t i = 0; i < count; i++)
        if (!isnan(beside->of[i][way].of[measure])) sum += (double)beside->of[i][way].of[measure] / known;
    return known ? sum : (double)NAN;
}
