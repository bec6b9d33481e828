/* SPDX-License-Identifier: MIT */
#include "eval/eval_speed.h"

#include <stdio.h>
#include <string.h>

#define PIXELS       512u  /* per side of the pictures (spec 5) */
#define CURVE_CASE   "E04" /* of the thesis' Figure 5.20 */
#define CURVE_FRAMES 3u

/* Frames of the plugin a second at one threshold, for every kernel. */
static bool time_curve(const hs_eval_study *study, uint32_t threshold, hs_eval_case *c, double *fps,
                       hs_error *err) {
    for (uint32_t k = 0; k < study->plan.kernel.count; k++) {
        hs_eval_values values;
        double ms;
        if (!hs_eval_study_values(study, (hs_eval_pick){threshold, k, 0}, &values, err) ||
            !hs_eval_case_time(c, &values, CURVE_FRAMES, &ms, err))
            return false;
        fps[k] = 1e3 / ms;
    }
    return true;
}

bool hs_eval_speed_curves(hs_eval_study *study, uint32_t index, hs_eval_case *c, hs_error *err) {
    const hs_eval_plan *plan = &study->plan;
    const char *name = study->space[index].name;
    const bool last = index + 1 == study->count && !study->curves;
    if (study->options->frames == 0 || !plan->threshold.exists || !plan->kernel.exists) return true;
    if (strcmp(name, CURVE_CASE) != 0 && !last) return true;
    (void)snprintf(study->curve_case, sizeof study->curve_case, "%s", name);
    for (uint32_t i = 0; i < HS_EVAL_CURVES; i++) {
        const uint32_t t = plan->threshold.count * i / HS_EVAL_CURVES;
        study->curve_threshold[i] = plan->threshold.value[t];
        if (!time_curve(study, t, c, study->curve_fps[i], err)) return false;
    }
    study->curves = HS_EVAL_CURVES;
    return true;
}

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
