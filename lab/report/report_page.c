/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "core/paths.h"
#include "core/system.h"
#include "loop/clipper.h"
#include "page/plot.h"

#include <math.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------- study -- */

static void put_table(hs_page *report, const hs_eval_study *study, hs_eval_table_kind kind) {
    hs_eval_rows table;
    hs_eval_rows_make(study, kind, &table);
    if (kind != HS_TABLE_PLAIN) hs_page_heading(report, 3, table.caption);
    hs_page_table_begin(report);
    for (uint32_t r = 0; r < table.rows; r++) {
        const char *cells[HS_EVAL_CELLS];
        uint32_t columns = 0;
        for (uint32_t c = 0; c < table.columns; c++)
            if (table.has[c]) cells[columns++] = table.row[r].cell[c];
        hs_page_table_row(report, cells, columns);
    }
    hs_page_table_end(report);
}

/* ------------------------------------------------------------------------------------ what comes first -- */
/* The plugin as it is, in figures and pictures. */

static const char *percent(double share, char out[32]) {
    (void)snprintf(out, 32, "-");
    if (!isnan(share)) (void)snprintf(out, 32, "%.1f\u00a0%%", share);
    return out;
}

/* The means, each with the case that is worst. */
static void put_means(hs_page *report, const hs_eval_study *study) {
    static const struct {
        int column;
        const char *unit, *name;
    } shown[4] = {{HS_PLAIN_CUT, "\u00a0%", "of the fetus cut"},
                  {HS_PLAIN_LEFT, "\u00a0%", "of what hides it left"},
                  {HS_PLAIN_ABS, " steps", "mean error e_abs"},
                  {HS_PLAIN_MS, "\u00a0ms", "a volume, in the plugin"}};
    double mean[HS_PLAIN_COUNT];
    char values[4][32], names[4][128];
    const char *name[4], *value[4];
    unsigned count = 0;
    hs_eval_plain_row(study, study->count, mean);
    for (int i = 0; i < 4; i++) {
        double most;
        const uint32_t index = hs_eval_plain_worst(study, shown[i].column, &most);
        if (index == study->count) continue;
        (void)snprintf(values[i], sizeof values[i], "%.1f%s", mean[shown[i].column], shown[i].unit);
        (void)snprintf(names[i], sizeof names[i], "%s (worst: %.1f%s, %.40s)", shown[i].name, most,
                       shown[i].unit, study->space[index].name);
        name[count] = names[i];
        value[count++] = values[i];
    }
    hs_page_numbers(report, name, value, count);
}

/* Full volume, result, ground truth: the order of every page. Why a result is not clipped stands below it. */
static void put_plain_case(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const hs_eval_result *r = &study->result[index];
    const bool clipped = hs_outcome_clips(study->plain.outcome[index]);
    double row[HS_PLAIN_COUNT];
    char caption[320], cut[32], left[32];
    hs_eval_plain_row(study, index, row);
    (void)snprintf(caption, sizeof caption, "Result: %scut %s, left %s", clipped ? "" : "not clipped, ",
                   percent(row[HS_PLAIN_CUT], cut), percent(row[HS_PLAIN_LEFT], left));
    hs_page_row_begin(report, "small");
    hs_eval_page_show(report, study, index, "full.png", "rendering of the full volume", "Full volume");
    hs_eval_page_show(report, study, index, "result.png", "rendering of the result", caption);
    hs_eval_page_show(report, study, index, "truth.png", "rendering of the ground truth",
                      hs_page_truth_caption(r->truth_cut));
    if (r->has_reference)
        hs_eval_page_show(report, study, index, "reference.png", "rendering of the reference",
                          "Reference: what an expert left of the volume");
    hs_page_row_end(report);
    if (r->doubt[0]) hs_page_text(report, r->doubt);
    if (r->note[0]) hs_page_text(report, r->note);
}

static void put_plain_details(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const bool clipped = hs_outcome_clips(study->plain.outcome[index]);
    hs_page_fold_begin(report, "How it was found, the error of every ray, and the plugin's confidence");
    hs_page_row_begin(report, "wide");
    hs_eval_page_show(report, study, index, "slices.png", "the result beside three slices",
                      hs_page_slices_caption(clipped));
    hs_page_row_end(report);
    hs_page_row_begin(report, "wide");
    hs_eval_page_show(report, study, index, "error.png",
                      "error per ray, blue where the fetus is cut, red where an occluder is left",
                      "Error: blue, the fetus is cut; red, an occluder is left; grey, not evaluated");
    hs_eval_page_show(report, study, index, "depthmap.png", "the clipping depthmap in false colour",
                      "Clipping depthmap: where the rays start; hatched: nothing is clipped");
    if (study->result[index].sure)
        hs_eval_page_show(report, study, index, "confidence.png", "confidence",
                          "Confidence: how sure the plugin says it is");
    hs_page_row_end(report);
    hs_page_fold_end(report);
}

static void put_first(hs_page *report, const hs_eval_study *study) {
    char text[600];
    const sv_descriptor *d = study->plugin.instance->descriptor;
    put_plain_case(report, study, 0);
    put_means(report, study);
    (void)snprintf(text, sizeof text,
                   "%.100s %.40s%s%.60s, as it is: nothing was chosen for these cases. Means of %u case%s; "
                   "above is the first, %s. The last section says what the words mean.",
                   d->id, d->version, strcmp(study->plain.name, d->id) == 0 ? "" : ", method ",
                   strcmp(study->plain.name, d->id) == 0 ? "" : study->plain.name, study->count,
                   study->count == 1 ? "" : "s", study->space[0].name);
    hs_page_text(report, text);
    if (study->plugin_error.code != HS_OK) hs_page_text(report, study->plugin_error.text);
    hs_page_contents(report);
    hs_page_heading(report, 2, "As it is");
    put_table(report, study, HS_TABLE_PLAIN);
    for (uint32_t i = 0; i < study->count; i++) {
        hs_page_heading(report, 3, study->space[i].name);
        hs_page_text(report, study->result[i].title);
        if (i > 0) put_plain_case(report, study, i);
        put_plain_details(report, study, i);
    }
}

/* ------------------------------------------------------------------------------- what the words mean -- */

static void put_words(hs_page *report, const hs_eval_study *study) {
    hs_page_heading(report, 2, "What the words mean");
    hs_page_text(
        report,
        "A case is a volume with its ground truth: the same without the occluder, which is what hides "
        "the fetus. The renderer goes along every ray of a picture in steps, one slice of the volume "
        "each, and the ray ends in the tissue it meets. The plugin gives a depthmap: for every ray the "
        "depth at which the renderer starts.");
    hs_page_text(report,
                 "A ray's error is the depth at which it ends in the ground truth minus that in the result. "
                 "Above 0 something that hides the fetus is left, below 0 the fetus is cut.");
    hs_page_text(
        report,
        "e_abs is the mean size of the error over the rays that meet fetus or amniotic sac, in steps; "
        "e_pos is the mean of the errors above 0, e_neg that of the size of those below. \"sac\" and "
        "\"fetus\" before them: over the rays of one of the two. Cut is the share of the fetus' rays "
        "with an error below -2 steps, left the share of the rays that were hidden and still have one "
        "above 2. Unclipped is the volume as it came.");
    for (uint32_t i = 0; i < study->count; i++) {
        if (isnan(study->plain.floor[i])) continue;
        hs_page_text(report,
                     "The true surface is the scene's own, taken as the depthmap: no map of this size "
                     "does better.");
        break;
    }
    if (study->options->look == HS_LOOK_LIT)
        hs_page_text(report,
                     "Renderings are lit: skin tones are surfaces, darker and redder with depth; grey is "
                     "tissue that the surface cuts, or where the scan ends; a blue veil is removed tissue, "
                     "shown faintly. Measures use the thesis' look.");
    hs_page_text(report,
                 "\"The thesis\" is Application of Smart Visibility on Medical 3D Ultrasound Datasets, "
                 "from which the measures come.");
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
        "Measured were %u thresholds x %u kernels x %u positions for every case. The best setting "
        "of a case, and the common one of all cases but for the position, are chosen by the ground "
        "truth, which no user has.",
        plan->threshold.count, plan->kernel.count, plan->knob.count);
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
        const double value =
            (double)m->of[i] * (i == HS_MEASURE_FETUS_CUT || i == HS_MEASURE_OCCLUDER_LEFT ? 100 : 1);
        (void)snprintf(text[i], sizeof text[i], isnan(value) ? "-" : "%.2f", value);
        cells[i + 1] = text[i];
    }
    hs_page_table_row(report, cells, HS_MEASURE_COUNT + 1);
}

static void put_numbers(hs_page *report, const hs_eval_study *study, uint32_t index) {
    static const char *const head[HS_MEASURE_COUNT + 1] = {
        "setting",     "e_abs",       "e_pos",       "e_neg",   "sac e_abs", "sac e_pos",    "sac e_neg",
        "fetus e_abs", "fetus e_pos", "fetus e_neg", "cut [%]", "left [%]",  "outside e_abs"};
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
    hs_page_row_begin(report, "");
    hs_eval_page_show(report, study, index, "common.png", "rendering at the common setting",
                      clipped ? "Result at the common setting" : "Result at the common setting: not clipped");
    put_slider(report, study, index);
    hs_page_row_end(report);
    hs_page_row_begin(report, "wide");
    hs_eval_page_show(report, study, index, "common_error.png", "error per ray at the common setting",
                      "Error at the common setting");
    hs_page_row_end(report);
    put_numbers(report, study, index);
    hs_eval_figure_space(report, study, index);
    hs_page_fold_end(report);
}

bool hs_eval_study_page(const hs_eval_study *study, hs_error *err) {
    char path[SYS_PATH], text[128], studied[64];
    hs_page report;
    if (!hs_path_join(study->options->out, "index.html", path, sizeof path, err)) return false;
    hs_page_open(&report, path, "SmartVis: evaluation");
    put_first(&report, study);
    hs_eval_method_name(&study->plugin, &study->plan.base, studied, sizeof studied);
    (void)snprintf(text, sizeof text, "The settings of %.60s, chosen by the truth", studied);
    hs_page_heading(&report, 2, text);
    put_terms(&report, study);
    put_table(&report, study, HS_TABLE_BEST);
    put_table(&report, study, HS_TABLE_COMMON);
    hs_page_text(&report, hs_eval_thesis_note);
    hs_eval_figure_mean(&report, study);
    for (uint32_t i = 0; i < study->count; i++) put_case(&report, study, i);
    hs_eval_figure_speed(&report, study);
    put_words(&report, study);
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
    hs_plot_bars_write(hs_page_stream(report), &plot);
}

static void show(hs_page *report, const char *folder, const char *file, const char *name,
                 const char *caption) {
    char path[SYS_PATH], alt[400];
    (void)snprintf(alt, sizeof alt, "%s: %s", name, caption);
    if (hs_path_join(folder, file, path, sizeof path, &report->error))
        hs_page_photo(report, path, alt, caption);
}

/* Puts the pictures of a plugin at the first seed, in the order of the ranking. */
static void put_renderings(hs_page *report, const hs_eval_comparison *x, uint32_t index) {
    char folder[SYS_PATH], file[32], caption[320];
    if (!hs_eval_compare_folder(x, index, folder, sizeof folder, &report->error)) return;
    hs_page_heading(report, 3, x->name[index]);
    if (x->doubt[index][0]) hs_page_text(report, x->doubt[index]);
    hs_page_row_begin(report, "");
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
    char path[SYS_PATH], text[400];
    hs_page report;
    if (!hs_path_join(x->options->out, "index.html", path, sizeof path, err)) return false;
    hs_page_open(&report, path, "SmartVis: comparison");
    (void)snprintf(
        text, sizeof text,
        "%u methods on %u cases with %u seeds each, ranked by e_abs at the given setting: the mean "
        "size of the error of a ray, in steps of one slice of the volume. \"Best position\" is the lowest "
        "e_abs that the primary parameter alone reaches on each volume.",
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
