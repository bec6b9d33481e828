/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "core/paths.h"
#include "core/system.h"
#include "page/plot.h"

#include <math.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------- parts -- */

void hs_eval_page_show(hs_page *report, const hs_eval_study *study, uint32_t index, const char *name,
                       const char *alt, const char *caption) {
    const bool drawn = strstr(name, "error") || strstr(name, "confidence") || strstr(name, "depthmap");
    char folder[SYS_PATH], path[SYS_PATH], full_alt[256];
    (void)snprintf(full_alt, sizeof full_alt, "%s: %s", study->space[index].name, alt);
    if (hs_path_join(study->options->out, study->space[index].name, folder, sizeof folder, &report->error) &&
        hs_path_join(folder, name, path, sizeof path, &report->error))
        (drawn ? hs_page_picture : hs_page_photo)(report, path, full_alt, caption);
}

/* ------------------------------------------------------------------------------------- parameter space -- */

static float lowest_over_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel) {
    return hs_eval_at(space, hs_eval_best_knob(space, threshold, kernel))->of[HS_MEASURE_ABS];
}

void hs_eval_figure_space(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_space *space = &study->space[index];
    const uint32_t kernels = plan->kernel.count;
    float value[HS_EVAL_MAX_LINE * HS_EVAL_MAX_LINE];
    double delta[HS_EVAL_MAX_LINE];
    char title[160];
    if (!plan->threshold.exists || !plan->kernel.exists) return;
    (void)snprintf(title, sizeof title, "%s: lowest e_abs over %s (as the thesis' Figure 5.7)", space->name,
                   plan->knob.exists ? plan->knob.info.key : "the primary parameter");
    hs_plot_heat plot = {.title = title,
                         .x_label = "Delta_MI = maximum of the volume - T_B (0 .. 1)",
                         .y_label = "kernel size k (pixels)",
                         .value_label = "e_abs (steps)",
                         .rows = kernels,
                         .x = delta,
                         .y = plan->kernel.value,
                         .value = value,
                         .mark_row = (int32_t)study->result[index].best.kernel};
    for (uint32_t t = plan->threshold.count; t-- > 0;) {
        /* Above the maximum there is no bone: nothing to show. */
        if (hs_eval_delta(space, t) < 0) continue;
        if (t == study->result[index].best.threshold) plot.mark_column = (int32_t)plot.columns;
        delta[plot.columns] = hs_eval_delta(space, t);
        for (uint32_t k = 0; k < kernels; k++)
            value[(size_t)plot.columns * kernels + k] = lowest_over_knob(space, t, k);
        plot.columns++;
    }
    if (plot.columns > 0) hs_plot_heat_write(hs_page_stream(report), &plot);
}

void hs_eval_figure_mean(hs_page *report, const hs_eval_study *study) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_mean *mean = &study->mean;
    float value[HS_EVAL_MAX_LINE * HS_EVAL_MAX_LINE];
    if (!plan->threshold.exists || !plan->kernel.exists || mean->deltas == 0) return;
    for (uint32_t i = 0; i < mean->deltas * mean->kernels; i++) {
        value[i] = INFINITY;
        for (uint32_t q = 0; q < mean->knobs; q++)
            value[i] = fminf(value[i], mean->e_abs[(size_t)i * mean->knobs + q]);
    }
    const hs_plot_heat plot = {
        .title = "All cases: lowest mean e_abs over the surface position (as the thesis' Figure 5.8)",
        .x_label = "Delta_MI = maximum of the volume - T_B (0 .. 1)",
        .y_label = "kernel size k (pixels)",
        .value_label = "mean e_abs (steps)",
        .columns = mean->deltas,
        .rows = mean->kernels,
        .x = mean->delta,
        .y = plan->kernel.value,
        .value = value,
        .mark_column = (int32_t)mean->best,
        .mark_row = (int32_t)mean->best_kernel};
    hs_plot_heat_write(hs_page_stream(report), &plot);
}

/* ----------------------------------------------------------------------------------------------- speed -- */

#define STAGES 5 /* of the plugin, as smartvis.timing/1 tells them */

static void stage_ms(const hs_loop_result *r, double ms[STAGES]) {
    const sv_stage_times *t = &r->plugin_stages;
    ms[0] = t->transfer_ms;
    ms[1] = t->profile_ms;
    ms[2] = t->threshold_ms;
    ms[3] = t->reconstruct_ms;
    ms[4] = t->output_ms;
}

static bool tells_stages(const hs_eval_study *study) {
    for (uint32_t i = 0; i < study->count; i++)
        if (!study->result[i].speed[HS_SETTING_SMARTVIS].has_plugin_stages) return false;
    return true;
}

/* Draws the thesis' Figure 5.21. */
static void put_settings(hs_page *report, const hs_eval_study *study, const char *const *names) {
    static const char *const labels[HS_SETTING_COUNT] = {"DVR", "+ conversion", "+ plugin"};
    double value[HS_EVAL_MAX_CASES * HS_SETTING_COUNT];
    for (uint32_t i = 0; i < study->count; i++)
        for (int s = 0; s < HS_SETTING_COUNT; s++)
            value[i * HS_SETTING_COUNT + (uint32_t)s] = study->result[i].speed[s].volumes_per_second;
    const hs_plot_bars plot = {.title = "Volumes a second in three settings (as the thesis' Figure 5.21)",
                               .y_label = "volumes a second",
                               .groups = study->count,
                               .series = HS_SETTING_COUNT,
                               .group = names,
                               .name = labels,
                               .value = value};
    hs_plot_bars_write(hs_page_stream(report), &plot);
}

/* Table 5.4: the average over the cases. */
static void put_table(hs_page *report, const hs_eval_study *study) {
    static const char *const head[3] = {"stage", "here [ms]", "thesis, Table 5.4 [ms]"};
    double mean[STAGES] = {0}, dvr = 0, loop = 0;
    char text[2][32];
    const bool known = tells_stages(study);
    for (uint32_t i = 0; i < study->count; i++) {
        const hs_loop_result *r = &study->result[i].speed[HS_SETTING_SMARTVIS];
        double ms[STAGES];
        stage_ms(r, ms);
        for (int s = 0; s < STAGES; s++) mean[s] += ms[s] / study->count;
        dvr += r->stage[HS_STAGE_DVR].median / study->count;
        loop += r->stage[HS_STAGE_LOOP].median / study->count;
    }
    const struct {
        const char *name;
        double ms;
        int thesis; /* of hs_eval_thesis_stages; -1: it does not tell */
    } rows[] = {{"transfer", known ? mean[0] : NAN, 0},
                {"ray profiles", known ? mean[1] : NAN, -1},
                {"threshold", known ? mean[2] : NAN, 1},
                {"surface", known ? mean[3] : NAN, 2},
                {"output", known ? mean[4] : NAN, -1},
                {"render", dvr, 3},
                {"whole frame", loop, 4}};
    hs_page_table_begin(report);
    hs_page_table_row(report, head, 3);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        if (isnan(rows[i].ms)) continue; /* the plugin does not tell */
        (void)snprintf(text[0], sizeof text[0], "%.3f", rows[i].ms);
        (void)snprintf(text[1], sizeof text[1], rows[i].thesis < 0 ? "-" : "%.3f",
                       rows[i].thesis < 0 ? 0.0 : hs_eval_thesis_stages[rows[i].thesis].ms);
        const char *cells[3] = {rows[i].name, text[0], text[1]};
        hs_page_table_row(report, cells, 3);
    }
    hs_page_table_end(report);
}

void hs_eval_figure_speed(hs_page *report, const hs_eval_study *study) {
    const char *names[HS_EVAL_MAX_CASES];
    char text[800];
    double lost = 0;
    for (uint32_t i = 0; i < study->count; i++) {
        if (!study->result[i].has_speed) return;
        names[i] = study->space[i].name;
        lost += (study->result[i].speed[HS_SETTING_CONVERT].volumes_per_second -
                 study->result[i].speed[HS_SETTING_SMARTVIS].volumes_per_second) /
                study->count;
    }
    hs_page_heading(report, 2, "Speed at the common setting");
    (void)snprintf(
        text, sizeof text,
        "Medians of %u frames on %s, pictures of 512 x 512. DVR is direct volume rendering, which draws the "
        "picture; "
        "scan conversion makes the low-resolution volume that the plugin gets. With the plugin a volume "
        "shows %.1f frames a second %s than with scan conversion alone; in the thesis the plugin cost %d a "
        "second on another machine with other data. A clipped picture can also be quicker: its rays "
        "skip what is cut away.",
        study->options->frames, study->cl.device_name, fabs(lost), lost >= 0 ? "fewer" : "more",
        HS_EVAL_THESIS_LOST_FPS);
    hs_page_text(report, text);
    put_settings(report, study, names);
    if (tells_stages(study))
        hs_page_text(
            report,
            "Stages of the plugin: transfer copies the volume to the device; ray profiles keeps of "
            "every ray what the rest needs; threshold finds what is bone, and so the initial points, "
            "where bone lies behind fluid; surface makes a depth for every ray of them; output writes "
            "the depthmap.");
    put_table(report, study);
    hs_page_text(report,
                 "The thesis' transfer is the preparation of a frame. Its threshold is called initial "
                 "points there, its surface mean filter, which worked on 512 x 512 pixels.");
}
