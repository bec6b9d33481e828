/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "base/paths.h"
#include "loop/clipper.h"
#include "page/plot.h"

#include <limits.h>
#include <math.h>

/* ----------------------------------------------------------------------------------------------- study -- */

static void put_table(hs_page *report, const hs_eval_study *study, hs_eval_table_kind kind) {
    char caption[300];
    hs_eval_row row;
    bool has[HS_EVAL_CELLS];
    hs_eval_row_caption(study, kind, caption, sizeof caption);
    hs_page_heading(report, 3, caption);
    hs_page_table_begin(report);
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++) has[i] = hs_eval_row_has(study, kind, i);
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        const char *cells[HS_EVAL_CELLS];
        uint32_t columns = 0;
        if (r > 0) hs_eval_row_make(study, kind, r - 1, &row);
        for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
            if (has[i]) cells[columns++] = r > 0 ? row.cell[i] : hs_eval_row_head(study)[i];
        hs_page_table_row(report, cells, columns);
    }
    hs_page_table_end(report);
}

/* ------------------------------------------------------------------------------------ what comes first -- */
/* The default method of a plugin that has the thesis', too; else the studied one at its common setting. */

static const hs_measures *first_measures(const hs_eval_study *study, uint32_t index) {
    return study->beside.exists ? &study->beside.of[index][HS_BESIDE_OTHER] : &study->result[index].shown;
}

static double first_ms(const hs_eval_study *study, uint32_t index) {
    const hs_eval_result *r = &study->result[index];
    if (study->beside.exists) return study->beside.repeats ? study->beside.ms[index] : (double)NAN;
    return r->has_speed ? r->speed[HS_SETTING_SMARTVIS].stage[HS_STAGE_PLUGIN].median : (double)NAN;
}

enum { FIRST_ABS, FIRST_CUT, FIRST_LEFT, FIRST_MS, FIRST_UNCLIPPED, FIRST_FLOOR, FIRST_COUNT };
static const char *const first_head[FIRST_COUNT + 1] = {
    "case", "e_abs", "cut [%]", "left [%]", "plugin [ms]", "e_abs unclipped", "e_abs of the true surface"};

/* The numbers of a case; NAN where one is not known. */
static void first_row(const hs_eval_study *study, uint32_t index, double out[FIRST_COUNT]) {
    const hs_measures *m = first_measures(study, index);
    out[FIRST_ABS] = (double)m->of[HS_MEASURE_ABS];
    out[FIRST_CUT] = 100 * (double)m->of[HS_MEASURE_FETUS_CUT];
    out[FIRST_LEFT] = 100 * (double)m->of[HS_MEASURE_OCCLUDER_LEFT];
    out[FIRST_MS] = first_ms(study, index);
    out[FIRST_UNCLIPPED] = (double)study->result[index].unclipped.of[HS_MEASURE_ABS];
    out[FIRST_FLOOR] = study->beside.exists
                           ? (double)study->beside.of[index][HS_BESIDE_TRUTH].of[HS_MEASURE_ABS]
                           : (double)NAN;
}

/* Over the cases that have it. */
static void first_means(const hs_eval_study *study, double mean[FIRST_COUNT]) {
    double row[FIRST_COUNT];
    uint32_t known[FIRST_COUNT] = {0};
    for (int k = 0; k < FIRST_COUNT; k++) mean[k] = 0;
    for (uint32_t i = 0; i < study->count; i++) {
        first_row(study, i, row);
        for (int k = 0; k < FIRST_COUNT; k++)
            if (!isnan(row[k])) {
                mean[k] += row[k];
                known[k]++;
            }
    }
    for (int k = 0; k < FIRST_COUNT; k++) mean[k] = known[k] ? mean[k] / known[k] : (double)NAN;
}

/* A column that is nowhere known is not there. */
static void first_table(hs_page *report, const hs_eval_study *study, const double mean[FIRST_COUNT]) {
    hs_page_table_begin(report);
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        double row[FIRST_COUNT];
        char text[FIRST_COUNT][32];
        const char *cells[FIRST_COUNT + 1] = {r == 0              ? first_head[0]
                                              : r <= study->count ? study->space[r - 1].name
                                                                  : "mean"};
        uint32_t columns = 1;
        if (r > 0 && r <= study->count) first_row(study, r - 1, row);
        for (int k = 0; k < FIRST_COUNT; k++) {
            const double value = r > study->count ? mean[k] : r > 0 ? row[k] : 0;
            if (isnan(mean[k])) continue;
            (void)snprintf(text[k], sizeof text[k], isnan(value) ? "-" : "%.2f", value);
            cells[columns++] = r == 0 ? first_head[k + 1] : text[k];
        }
        hs_page_table_row(report, cells, columns);
    }
    hs_page_table_end(report);
}

static void first_case(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const bool beside = study->beside.exists;
    double row[FIRST_COUNT];
    char caption[128];
    first_row(study, index, row);
    if (isnan(row[FIRST_CUT]))
        (void)snprintf(caption, sizeof caption, "Result: left %.1f\u00a0%%", row[FIRST_LEFT]);
    else
        (void)snprintf(caption, sizeof caption, "Result: cut %.1f\u00a0%%, left %.1f\u00a0%%", row[FIRST_CUT],
                       isnan(row[FIRST_LEFT]) ? 0.0 : row[FIRST_LEFT]);
    hs_page_heading(report, 3, study->space[index].name);
    hs_page_text(report, study->result[index].title);
    hs_page_small_row_begin(report);
    hs_eval_page_show(report, study, index, "full.png", "rendering of the full volume", "Full volume");
    hs_eval_page_show(report, study, index, beside ? "beside_other.png" : "result.png",
                      "rendering of the result", caption);
    hs_eval_page_show(report, study, index, "truth.png", "rendering of the ground truth",
                      hs_page_truth_caption(study->result[index].truth_cut));
    hs_page_row_end(report);
}

/* The terms of all that follows, then the method in figures, in a table and in pictures. */
static void put_first(hs_page *report, const hs_eval_study *study) {
    static const char *const names[4] = {"of the fetus cut", "of what hides it left", "steps: e_abs",
                                         "a volume, in the plugin"};
    static const int shown[4] = {FIRST_CUT, FIRST_LEFT, FIRST_ABS, FIRST_MS};
    static const char *const formats[4] = {"%.1f %%", "%.1f %%", "%.2f", "%.1f ms"};
    double mean[FIRST_COUNT];
    char text[600], values[4][32];
    const char *name[4], *value[4];
    const sv_descriptor *d = study->plugin.instance->descriptor;
    uint32_t count = 0;
    first_means(study, mean);
    hs_page_text(
        report,
        "A case is a volume with its ground truth: the same without the occluder, which is what hides the "
        "fetus. The renderer goes "
        "along every ray of a picture in steps, one slice of the volume each, and the ray ends in the "
        "tissue it meets. The plugin gives a depthmap: for every ray the depth at which the renderer starts. "
        "A method is a way to find it.");
    hs_page_text(
        report,
        "A ray's error is the depth at which it ends in the ground truth minus that in the result. Above 0 "
        "something that hides the fetus is left, below 0 the fetus is cut.");
    hs_page_text(
        report,
        "e_abs is the mean size of the error over the rays that meet fetus or amniotic sac, in steps. Cut is "
        "the share of the fetus' rays with an error below -2 steps, left the share of the rays that "
        "were hidden and still have one above 2. Unclipped is the volume as it came.");
    hs_page_text(
        report,
        "\"The thesis\" is Application of Smart Visibility on Medical 3D Ultrasound Datasets, from which "
        "the measures come.");
    if (!isnan(mean[FIRST_FLOOR]))
        hs_page_text(report,
                     "The true surface is the scene's own, taken as the depthmap: no map of this size does "
                     "better.");
    for (int i = 0; i < 4; i++) {
        if (isnan(mean[shown[i]])) continue;
        (void)snprintf(values[i], sizeof values[i], formats[i], mean[shown[i]]);
        name[count] = names[i];
        value[count++] = values[i];
    }
    hs_page_numbers(report, name, value, count);
    (void)snprintf(text, sizeof text,
                   "%.100s %.40s, %s, in the mean of %u case%s; a depthmap has %u pixels across.", d->id,
                   d->version,
                   study->beside.exists ? study->beside.other_name : "at the setting that is best for all",
                   study->count, study->count == 1 ? "" : "s", study->map_side);
    hs_page_text(report, text);
    if (study->plugin_error.code != HS_OK) hs_page_text(report, study->plugin_error.text);
    hs_page_contents(report);
    (void)snprintf(text, sizeof text, "%.60s%s", study->beside.exists ? study->beside.other_name : d->id,
                   study->beside.exists && !study->options->beside ? ", the default method" : "");
    hs_page_heading(report, 2, text);
    first_table(report, study, mean);
    if (study->options->look == HS_LOOK_LIT)
        hs_page_text(report,
                     "Renderings are lit: skin tones are surfaces, darker and redder with depth; grey is "
                     "tissue that the surface cuts, or where the scan ends; a blue veil is removed tissue, "
                     "shown faintly. Measures use the thesis' look.");
    for (uint32_t i = 0; i < study->count; i++) first_case(report, study, i);
}

/* ------------------------------------------------------------------------------- the parameter space -- */

/* What the studied method's tables and figures speak of, as far as the plugin has it. */
static void put_terms(hs_page *report, const hs_eval_study *study) {
    const hs_eval_plan *plan = &study->plan;
    char text[600];
    if (plan->threshold.exists)
        hs_page_text(report,
                     "T_B is the threshold from which on an echo is bone, 0 .. 1. Delta_MI is the largest "
                     "value of the volume minus T_B, so that it means the same in bright and dark volumes.");
    if (plan->kernel.exists)
        hs_page_text(report, "k is the width of the filter's kernel in pixels of the depthmap.");
    if (plan->knob.exists) {
        (void)snprintf(text, sizeof text, "The parameter that every user sees is %.60s (%.30s).",
                       plan->knob.info.label, plan->knob.info.key);
        hs_page_text(report, text);
    }
    (void)snprintf(
        text, sizeof text,
        "Measured were %u thresholds x %u kernels x %u positions for every case. The common "
        "setting is one for all cases, but for the position; e_pos is the mean of the errors above 0, e_neg "
        "that of the size of those below. \"sac\" and \"fetus\" before them: over the rays of one of the "
        "two.",
        plan->threshold.count, plan->kernel.count, plan->knob.count);
    hs_page_text(report, text);
    if (!study->checked) return;
    (void)snprintf(
        text, sizeof text,
        "%u settings were measured the direct way, too: the largest difference of e_abs is %g steps.",
        study->checked, study->check_worst[0]);
    hs_page_text(report, text);
}

static void put_slider(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const hs_eval_result *r = &study->result[index];
    const sv_param_info *info = &study->plan.knob.info;
    char label[128];
    if (r->turns == 0) return;
    (void)snprintf(label, sizeof label, "%.64s (%.32s)", info->label, info->key);
    hs_page_slider_begin(report, label, r->turns, r->turned);
    for (uint32_t i = 0; i < r->turns; i++) {
        char name[32], caption[64];
        (void)snprintf(name, sizeof name, "position_%u.png", i);
        (void)snprintf(caption, sizeof caption, "%.32s = %.4g", info->key, r->turn[i]);
        hs_eval_page_show(report, study, index, name, caption, caption);
    }
    hs_page_slider_end(report);
}

static void number_row(hs_page *report, const char *name, const hs_measures *m) {
    char text[HS_MEASURE_COUNT][32];
    const char *cells[HS_MEASURE_COUNT + 1] = {name};
    for (int i = 0; i < HS_MEASURE_COUNT; i++) {
        const double value = (double)m->of[i] * (i >= HS_MEASURE_FETUS_CUT ? 100 : 1);
        (void)snprintf(text[i], sizeof text[i], isnan(value) ? "-" : "%.2f", value);
        cells[i + 1] = text[i];
    }
    hs_page_table_row(report, cells, HS_MEASURE_COUNT + 1);
}

static void put_numbers(hs_page *report, const hs_eval_study *study, uint32_t index) {
    static const char *const head[HS_MEASURE_COUNT + 1] = {
        "setting",   "e_abs",       "e_pos",       "e_neg",       "sac e_abs", "sac e_pos",
        "sac e_neg", "fetus e_abs", "fetus e_pos", "fetus e_neg", "cut [%]",   "left [%]"};
    const hs_eval_result *r = &study->result[index];
    hs_page_table_begin(report);
    hs_page_table_row(report, head, HS_MEASURE_COUNT + 1);
    number_row(report, "unclipped", &r->unclipped);
    number_row(report, "common setting", &r->shown);
    number_row(report, "best setting", hs_eval_at(&study->space[index], r->best));
    hs_page_table_end(report);
}

static void put_case(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const bool clipped = hs_outcome_clips(study->result[index].shown_outcome);
    hs_page_fold_begin(report, study->space[index].name);
    hs_page_row_begin(report);
    hs_eval_page_show(report, study, index, "result.png",
                      clipped ? "rendering clipped at the plugin's depthmap" : "rendering, not clipped",
                      clipped ? "Result at the common setting" : "Result at the common setting: not clipped");
    put_slider(report, study, index);
    hs_page_row_end(report);
    hs_page_wide_row_begin(report);
    hs_eval_page_show(report, study, index, "depthmap.png", "the clipping depthmap in false colour",
                      "Clipping depthmap: where the rays start, in mm; hatched: nothing is clipped");
    hs_eval_page_show(
        report, study, index, "error_rays.png",
        "error per ray, blue where the fetus is cut, red where an occluder is left",
        "Error, from -40 to 40 steps: blue, the fetus is cut; red, an occluder is left; grey, not evaluated");
    hs_page_row_end(report);
    hs_page_wide_row_begin(report);
    hs_eval_page_show(report, study, index, "slices.png", "the result beside three slices",
                      hs_page_slices_caption(clipped));
    hs_page_row_end(report);
    put_numbers(report, study, index);
    hs_eval_figure_space(report, study, index);
    hs_page_fold_end(report);
}

bool hs_eval_study_page(const hs_eval_study *study, hs_error *err) {
    char path[PATH_MAX], text[128];
    hs_page report;
    if (!hs_path_join(study->options->out, "index.html", path, sizeof path, err)) return false;
    hs_page_open(&report, path, "SmartVis: evaluation");
    put_first(&report, study);
    hs_eval_page_beside(&report, study);
    (void)snprintf(text, sizeof text, "The settings of %.60s",
                   study->beside.exists ? study->beside.first_name : study->plugin.instance->descriptor->id);
    hs_page_heading(&report, 2, text);
    put_terms(&report, study);
    put_table(&report, study, HS_TABLE_BEST);
    put_table(&report, study, HS_TABLE_COMMON);
    hs_page_text(&report, hs_eval_thesis_note);
    hs_eval_figure_mean(&report, study);
    for (uint32_t i = 0; i < study->count; i++) put_case(&report, study, i);
    hs_eval_figure_speed(&report, study);
    return hs_page_close(&report, err);
}

/* ------------------------------------------------------------------------------------------ comparison -- */

#define CELL     64u /* bytes */
#define MAX_BARS 8u  /* series a figure can tell apart */

static void put_ranking(hs_page *report, const hs_eval_comparison *x) {
    static const char *const head[] = {
        "rank", "method", "e_abs", "best position", "fetus cut [%]", "occluder left [%]", "without surface"};
    hs_page_table_begin(report);
    hs_page_table_row(report, head, 7);
    for (uint32_t r = 0; r < x->count; r++) {
        const uint32_t m = x->rank[r];
        char text[6][CELL];
        (void)snprintf(text[0], CELL, "%u", r + 1);
        (void)snprintf(text[1], CELL, "%.2f", hs_eval_method_mean(x, m, HS_METHOD_ABS));
        (void)snprintf(text[2], CELL, "%.2f", hs_eval_method_mean(x, m, HS_METHOD_BEST));
        (void)snprintf(text[3], CELL, "%.2f", 100 * hs_eval_method_mean(x, m, HS_METHOD_CUT));
        (void)snprintf(text[4], CELL, "%.2f", 100 * hs_eval_method_mean(x, m, HS_METHOD_LEFT));
        (void)snprintf(text[5], CELL, "%u of %u", x->method[m].no_surface, x->options->case_count * x->seeds);
        const char *cells[7] = {text[0], x->method[m].label, text[1], text[2], text[3], text[4], text[5]};
        hs_page_table_row(report, cells, 7);
    }
    hs_page_table_end(report);
}

/* Every method against the first. */
static void put_differences(hs_page *report, const hs_eval_comparison *x) {
    const char *cells[HS_EVAL_MAX_CASES + 1] = {"method"};
    char text[HS_EVAL_MAX_CASES][CELL];
    const uint32_t cases = x->options->case_count;
    for (uint32_t i = 0; i < cases; i++) cells[i + 1] = x->name[i];
    hs_page_table_begin(report);
    hs_page_table_row(report, cells, cases + 1);
    for (uint32_t r = 1; r < x->count; r++) {
        cells[0] = x->method[x->rank[r]].label;
        for (uint32_t i = 0; i < cases; i++) {
            const hs_eval_difference d = hs_eval_compare_case(x, x->rank[r], x->rank[0], i);
            if (isnan(d.spread))
                (void)snprintf(text[i], CELL, "%+.2f", d.mean);
            else
                (void)snprintf(text[i], CELL, "%+.2f (spread %.2f)%s", d.mean, d.spread,
                               d.exceeds ? " *" : "");
            cells[i + 1] = text[i];
        }
        hs_page_table_row(report, cells, cases + 1);
    }
    hs_page_table_end(report);
}

static void write_bars(FILE *out, const void *plot) {
    hs_plot_bars_write(out, plot);
}

/* e_abs per case, of the first eight. */
static void put_bars(hs_page *report, const hs_eval_comparison *x) {
    const uint32_t cases = x->options->case_count, series = x->count < MAX_BARS ? x->count : MAX_BARS;
    double value[HS_EVAL_MAX_CASES * MAX_BARS];
    char text[MAX_BARS][CELL];
    const char *names[MAX_BARS], *groups[HS_EVAL_MAX_CASES];
    for (uint32_t r = 0; r < series; r++) {
        (void)snprintf(text[r], CELL, "rank %u", r + 1);
        names[r] = text[r];
        for (uint32_t i = 0; i < cases; i++) {
            value[i * series + r] = 0;
            for (uint32_t s = 0; s < x->seeds; s++)
                value[i * series + r] += (double)x->method[x->rank[r]].of[HS_METHOD_ABS][i][s] / x->seeds;
        }
    }
    for (uint32_t i = 0; i < cases; i++) groups[i] = x->name[i];
    const hs_plot_bars plot = {.title = "e_abs per case, mean over the seeds",
                               .y_label = "e_abs (steps)",
                               .groups = cases,
                               .series = series,
                               .group = groups,
                               .name = names,
                               .value = value};
    hs_eval_figure_put(report, write_bars, &plot);
}

static void show(hs_page *report, const char *folder, const char *file, const char *name,
                 const char *caption) {
    char path[PATH_MAX], alt[400];
    (void)snprintf(alt, sizeof alt, "%s: %s", name, caption);
    if (hs_path_join(folder, file, path, sizeof path, &report->error))
        hs_page_photo(report, path, alt, caption);
}

/* Puts the pictures of a plugin at the first seed, in the order of the ranking. */
static void put_renderings(hs_page *report, const hs_eval_comparison *x, uint32_t index) {
    char folder[PATH_MAX], file[32], caption[320];
    if (!hs_eval_compare_folder(x, index, folder, sizeof folder, &report->error)) return;
    hs_page_heading(report, 3, x->name[index]);
    hs_page_row_begin(report);
    show(report, folder, "full.png", x->name[index], "Full volume");
    for (uint32_t r = 0; r < x->count; r++) {
        const uint32_t m = x->rank[r];
        hs_eval_compare_file(m, file, sizeof file);
        (void)snprintf(caption, sizeof caption, "%u: %s, e_abs %.2f", r + 1, x->method[m].label,
                       (double)x->method[m].of[HS_METHOD_ABS][index][0]);
        show(report, folder, file, x->name[index], caption);
    }
    show(report, folder, "truth.png", x->name[index], hs_page_truth_caption(x->truth_cut[index]));
    hs_page_row_end(report);
}

bool hs_eval_compare_page(const hs_eval_comparison *x, hs_error *err) {
    char path[PATH_MAX], text[400];
    hs_page report;
    if (!hs_path_join(x->options->out, "index.html", path, sizeof path, err)) return false;
    hs_page_open(&report, path, "SmartVis: comparison");
    (void)snprintf(
        text, sizeof text,
        "%u methods on %u cases with %u seeds each, ranked by e_abs at the given setting: the mean "
        "size of the error of a ray, in steps of one slice of the volume. \"Best position\" is the lowest "
        "e_abs "
        "that the primary parameter alone reaches on each volume.",
        x->count, x->options->case_count, x->seeds);
    hs_page_text(&report, text);
    hs_page_text(&report,
                 "Read the shares beside the rank: a method that cuts the whole fetus can have a lower e_abs "
                 "than one that clips nothing.");
    hs_page_contents(&report);
    hs_page_heading(&report, 2, "Ranking");
    put_ranking(&report, x);
    put_bars(&report, x);
    hs_page_heading(&report, 2, "Difference to the first");
    hs_page_text(&report,
                 "e_abs minus that of the first, per case: the mean over the seeds, and the standard "
                 "deviation of the seeds' differences. A star marks a difference that exceeds this spread; "
                 "one without a star may come from the speckle alone.");
    put_differences(&report, x);
    hs_page_heading(&report, 2, "Pictures");
    hs_page_text(&report, "Every case at its first seed; the number is the rank.");
    for (uint32_t i = 0; i < x->options->case_count; i++) put_renderings(&report, x, i);
    return hs_page_close(&report, err);
}
