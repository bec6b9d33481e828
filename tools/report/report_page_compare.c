/* SPDX-License-Identifier: MIT */
#include "report/report_page_compare.h"

#include "base/paths.h"
#include "picture/plot.h"
#include "report/report_page_parts.h"
#include "report/report_pictures_compare.h"

#include <limits.h>
#include <math.h>

#define CELL     64u /* bytes */
#define MAX_BARS 8u  /* series a figure can tell apart */

static void put_ranking(hs_page *report, const hs_eval_comparison *x) {
    static const char *const head[] = {
        "rank", "method", "e_abs", "best knob", "fetus cut [%]", "occluder left [%]", "without surface"};
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
                               .y_label = "e_abs (DVR steps)",
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

/* In the order of the ranking, at the first seed. */
static void put_pictures(hs_page *report, const hs_eval_comparison *x, uint32_t index) {
    char folder[PATH_MAX], file[32], caption[320];
    if (!hs_eval_compare_folder(x, index, folder, sizeof folder, &report->error)) return;
    hs_page_heading(report, 3, x->name[index]);
    hs_page_row_begin(report);
    show(report, folder, "full.png", x->name[index], "Full volume");
    show(report, folder, "truth.png", x->name[index], "Ground truth");
    for (uint32_t r = 0; r < x->count; r++) {
        const uint32_t m = x->rank[r];
        hs_eval_compare_file(m, file, sizeof file);
        (void)snprintf(caption, sizeof caption, "%u: %s, e_abs %.2f", r + 1, x->method[m].label,
                       (double)x->method[m].of[HS_METHOD_ABS][index][0]);
        show(report, folder, file, x->name[index], caption);
    }
    hs_page_row_end(report);
}

bool hs_eval_compare_page(const hs_eval_comparison *x, hs_error *err) {
    char path[PATH_MAX], text[400];
    hs_page report;
    if (!hs_path_join(x->options->out, "index.html", path, sizeof path, err)) return false;
    hs_page_open(&report, path, "SmartVis: comparison");
    (void)snprintf(text, sizeof text,
                   "%u methods on %u cases with %u seeds each, ranked by e_abs in DVR steps at the given "
                   "setting. \"Best knob\" is the lowest e_abs that the knob alone reaches on each volume.",
                   x->count, x->options->case_count, x->seeds);
    hs_page_text(&report, text);
    hs_page_text(&report,
                 "Read the shares beside the rank: a method that cuts the whole fetus can have a lower e_abs "
                 "than one that clips nothing.");
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
    for (uint32_t i = 0; i < x->options->case_count; i++) put_pictures(&report, x, i);
    return hs_page_close(&report, err);
}
