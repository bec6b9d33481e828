/* SPDX-License-Identifier: MIT */
#include "report/report_page_speed.h"

#include "eval/eval_study.h"
#include "picture/plot.h"
#include "report/report_page_parts.h"

#include <math.h>

#define STAGES 5 /* of the plugin, as smartvis.timing/1 tells them */

static const char *const stage_names[STAGES] = {"transfer", "ray profiles", "threshold", "surface", "output"};

static void stage_ms(const hs_loop_result *r, double ms[STAGES]) {
    const sv_stage_times *t = &r->plugin_stages;
    ms[0] = t->transfer_ms;
    ms[1] = t->profile_ms;
    ms[2] = t->threshold_ms;
    ms[3] = t->reconstruct_ms;
    ms[4] = t->output_ms;
}

static void write_bars(FILE *out, const void *plot) {
    hs_plot_bars_write(out, plot);
}

static void write_lines(FILE *out, const void *plot) {
    hs_plot_lines_write(out, plot);
}

/* Figure 5.19: the height of a bar is the plugin's frame rate, its parts are the stages' shares. */
static void put_stages(hs_page *report, const hs_eval_study *study, const char *const *names) {
    double value[HS_EVAL_MAX_CASES * STAGES];
    for (uint32_t i = 0; i < study->count; i++) {
        const hs_loop_result *r = &study->result[i].speed[HS_SETTING_SMARTVIS];
        double ms[STAGES], sum = 0;
        if (!r->has_plugin_stages) return;
        stage_ms(r, ms);
        for (int s = 0; s < STAGES; s++) sum += ms[s];
        for (int s = 0; s < STAGES; s++)
            value[i * STAGES + (uint32_t)s] = sum > 0 ? 1e3 / sum * ms[s] / sum : 0;
    }
    const hs_plot_bars plot = {.title = "The plugin's frame rate, parted by stage (as Figure 5.19)",
                               .y_label = "frames of the plugin a second",
                               .groups = study->count,
                               .series = STAGES,
                               .group = names,
                               .name = stage_names,
                               .value = value,
                               .stacked = 1};
    hs_eval_figure_put(report, write_bars, &plot);
}

/* Figure 5.21. */
static void put_settings(hs_page *report, const hs_eval_study *study, const char *const *names) {
    static const char *const labels[HS_SETTING_COUNT] = {"DVR", "+ conversion", "+ plugin"};
    double value[HS_EVAL_MAX_CASES * HS_SETTING_COUNT];
    for (uint32_t i = 0; i < study->count; i++)
        for (int s = 0; s < HS_SETTING_COUNT; s++)
            value[i * HS_SETTING_COUNT + (uint32_t)s] = study->result[i].speed[s].volumes_per_second;
    const hs_plot_bars plot = {.title = "Volumes a second in three settings (as Figure 5.21)",
                               .y_label = "volumes a second",
                               .groups = study->count,
                               .series = HS_SETTING_COUNT,
                               .group = names,
                               .name = labels,
                               .value = value};
    hs_eval_figure_put(report, write_bars, &plot);
}

/* Figure 5.20. */
static void put_curves(hs_page *report, const hs_eval_study *study) {
    char names[HS_EVAL_CURVES][32], title[128];
    const char *name[HS_EVAL_CURVES];
    if (study->curves == 0) return;
    for (uint32_t i = 0; i < study->curves; i++) {
        (void)snprintf(names[i], sizeof names[i], "T_B = %.2f", study->curve_threshold[i]);
        name[i] = names[i];
    }
    (void)snprintf(title, sizeof title, "%s: the plugin's frame rate over k (as Figure 5.20)",
                   study->curve_case);
    const hs_plot_lines plot = {.title = title,
                                .x_label = "kernel size k (pixels)",
                                .y_label = "frames of the plugin a second",
                                .points = study->plan.kernel.count,
                                .series = study->curves,
                                .x = study->plan.kernel.value,
                                .value = &study->curve_fps[0][0],
                                .stride = HS_EVAL_MAX_LINE,
                                .name = name};
    hs_eval_figure_put(report, write_lines, &plot);
}

/* Table 5.4: the average over the cases. */
static void put_table(hs_page *report, const hs_eval_study *study) {
    static const char *const head[3] = {"stage", "here [ms]", "thesis, Table 5.4 [ms]"};
    double mean[STAGES] = {0}, dvr = 0, loop = 0;
    char text[2][32];
    bool known = true;
    for (uint32_t i = 0; i < study->count; i++) {
        const hs_loop_result *r = &study->result[i].speed[HS_SETTING_SMARTVIS];
        double ms[STAGES];
        stage_ms(r, ms);
        known = known && r->has_plugin_stages;
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
                {"initial points", known ? mean[2] : NAN, 1},
                {"mean filter", known ? mean[3] : NAN, 2},
                {"output", known ? mean[4] : NAN, -1},
                {"render", dvr, 3},
                {"whole frame", loop, 4}};
    hs_page_table_begin(report);
    hs_page_table_row(report, head, 3);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        (void)snprintf(text[0], sizeof text[0], isnan(rows[i].ms) ? "-" : "%.3f", rows[i].ms);
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
    hs_page_heading(report, 2, "Speed");
    (void)snprintf(
        text, sizeof text,
        "Medians of %u frames on %s, pictures of 512 x 512. With the plugin a volume shows %.1f "
        "frames a second %s than with scan conversion alone; in the thesis the plugin cost %d a "
        "second on another machine with other data. A clipped picture can also be quicker: its rays "
        "skip what is cut away.",
        study->options->frames, study->cl.device_name, fabs(lost), lost >= 0 ? "fewer" : "more",
        HS_EVAL_THESIS_LOST_FPS);
    hs_page_text(report, text);
    put_settings(report, study, names);
    put_stages(report, study, names);
    put_curves(report, study);
    put_table(report, study);
    hs_page_text(report, "The thesis' setup is the preparation of a frame, ours the copy of the slabs; its "
                         "mean filter worked on 512 x 512 pixels.");
}
