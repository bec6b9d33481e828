/* SPDX-License-Identifier: MIT */
#include "report/report_rows.h"

#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"
#include "eval/eval_study.h"
#include "report/report_rows_beside.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>

enum {
    CASE,
    THRESHOLD,
    DELTA,
    KERNEL,
    KNOB,
    E_ABS,
    E_POS,
    E_NEG,
    FETUS_CUT,
    OCCLUDER_LEFT,
    UNCLIPPED,
    THESIS_KNOB,
    THESIS_E_ABS
};

const char *const *hs_eval_row_head(const hs_eval_study *study) {
    (void)study;
    static const char *const head[HS_EVAL_CELLS] = {
        "case",  "T_B",     "Delta_MI", "k",         "knob",     "e_abs",       "e_pos",
        "e_neg", "cut [%]", "left [%]", "unclipped", "thesis q", "thesis e_abs"};
    return head;
}

static void put(hs_eval_row *row, uint32_t column, const char *format, double value) {
    if (isnan(value))
        (void)snprintf(row->cell[column], HS_EVAL_CELL, "-");
    else
        (void)snprintf(row->cell[column], HS_EVAL_CELL, format, value);
}

static hs_eval_pick pick_of(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t index) {
    return kind == HS_TABLE_BEST ? study->result[index].best : study->result[index].common;
}

static void put_measures(hs_eval_row *row, const hs_measures *m, double unclipped) {
    put(row, E_ABS, "%.2f", (double)m->of[HS_MEASURE_ABS]);
    put(row, E_POS, "%.2f", (double)m->of[HS_MEASURE_POS]);
    put(row, E_NEG, "%.2f", (double)m->of[HS_MEASURE_NEG]);
    put(row, FETUS_CUT, "%.2f", 100 * (double)m->of[HS_MEASURE_FETUS_CUT]);
    put(row, OCCLUDER_LEFT, "%.2f", 100 * (double)m->of[HS_MEASURE_OCCLUDER_LEFT]);
    put(row, UNCLIPPED, "%.2f", unclipped);
}

/* The mean of a measure over the cases that have it: without a fetus nothing of one is cut. */
static float known_mean(const hs_eval_study *study, hs_eval_table_kind kind, int measure) {
    float sum = 0.0f;
    uint32_t known = 0;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i < study->count; i++) {
            const float of = hs_eval_at(&study->space[i], pick_of(study, kind, i))->of[measure];
            if (isnan(of)) continue;
            if (pass == 0)
                known++;
            else
                sum += of / (float)known;
        }
    return known ? sum : NAN;
}

/* Means of what is known; the common setting in Table 5.3. */
static void make_average(const hs_eval_study *study, hs_eval_table_kind kind, hs_eval_row *row) {
    hs_measures mean;
    double unclipped = 0, thesis = 0;
    uint32_t in_thesis = 0;
    for (uint32_t i = 0; i < study->count; i++) {
        const hs_eval_thesis_case *t = hs_eval_thesis_find(study->space[i].name);
        unclipped += (double)study->result[i].unclipped.of[HS_MEASURE_ABS] / study->count;
        if (!t) continue;
        in_thesis++;
        thesis += kind == HS_TABLE_BEST ? t->e_abs : t->common_e_abs;
    }
    for (int k = 0; k < HS_MEASURE_COUNT; k++) mean.of[k] = known_mean(study, kind, k);
    (void)snprintf(row->cell[CASE], HS_EVAL_CELL, "mean");
    put_measures(row, &mean, unclipped);
    put(row, THESIS_E_ABS, "%.2f", in_thesis ? thesis / in_thesis : NAN);
}

void hs_eval_row_make(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t index, hs_eval_row *row) {
    const hs_eval_plan *plan = &study->plan;
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++) put(row, i, "%g", NAN);
    if (index >= study->count) {
        make_average(study, kind, row);
        return;
    }
    const hs_eval_space *space = &study->space[index];
    const hs_eval_thesis_case *t = hs_eval_thesis_find(space->name);
    const hs_eval_pick pick = pick_of(study, kind, index);
    (void)snprintf(row->cell[CASE], HS_EVAL_CELL, "%.31s", space->name);
    put(row, THRESHOLD, "%.2f", plan->threshold.exists ? plan->threshold.value[pick.threshold] : NAN);
    put(row, DELTA, "%.2f", hs_eval_delta(space, pick.threshold));
    put(row, KERNEL, "%.0f", plan->kernel.exists ? plan->kernel.value[pick.kernel] : NAN);
    put(row, KNOB, "%.4g", plan->knob.exists ? plan->knob.value[pick.knob] : NAN);
    put_measures(row, hs_eval_at(space, pick), (double)study->result[index].unclipped.of[HS_MEASURE_ABS]);
    if (!t) return;
    put(row, THESIS_KNOB, "%.2f", kind == HS_TABLE_BEST ? t->knob : t->common_knob);
    put(row, THESIS_E_ABS, "%.2f", kind == HS_TABLE_BEST ? t->e_abs : t->common_e_abs);
}

void hs_eval_row_caption(const hs_eval_study *study, hs_eval_table_kind kind, char *out, size_t bytes) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_mean *mean = &study->mean;
    if (kind == HS_TABLE_BEST)
        (void)snprintf(out, bytes, "Each case's setting with the lowest e_abs (thesis, Table 5.2)");
    else if (!plan->threshold.exists || !plan->kernel.exists)
        (void)snprintf(out, bytes, "Each case's best position of the knob (this plugin has no T_B and k)");
    else if (mean->deltas == 0)
        (void)snprintf(out, bytes, "The cases have no Delta_MI in common: each case's own best setting");
    else
        (void)snprintf(
            out, bytes,
            "Delta_MI = %.2f and k = %.0f for all cases, each case's best knob (thesis, Table "
            "5.3); with one knob position for all, %.4g, the mean e_abs is %.2f",
            mean->delta[mean->best], plan->kernel.value[mean->best_kernel],
            plan->knob.exists ? plan->knob.value[mean->best_knob] : NAN,
            (double)mean->e_abs[((size_t)mean->best * mean->kernels + mean->best_kernel) * mean->knobs +
                                mean->best_knob]);
}

/* ------------------------------------------------------------------------------------------- outputs -- */

static const int widths[HS_EVAL_CELLS] = {-6, 6, 9, 4, 6, 7, 7, 7, 9, 9, 10, 10, 13};

static void print_table(const hs_eval_study *study, hs_eval_table_kind kind, FILE *out) {
    char caption[300];
    hs_eval_row row;
    hs_eval_row_caption(study, kind, caption, sizeof caption);
    hs_print(out, "%s\n", caption);
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++) hs_print(out, "%*s", widths[i], hs_eval_row_head(study)[i]);
    (void)fprintf(out, "\n");
    for (uint32_t r = 0; r <= study->count; r++) {
        hs_eval_row_make(study, kind, r, &row);
        for (uint32_t i = 0; i < HS_EVAL_CELLS; i++) hs_print(out, "%*s", widths[i], row.cell[i]);
        (void)fprintf(out, "\n");
    }
    (void)fprintf(out, "\n");
}

void hs_eval_study_print(const hs_eval_study *study, FILE *out) {
    print_table(study, HS_TABLE_BEST, out);
    print_table(study, HS_TABLE_COMMON, out);
    hs_eval_beside_print(study, out);
}

static bool write_table(const hs_eval_study *study, hs_eval_table_kind kind, const char *name,
                        hs_error *err) {
    char path[PATH_MAX];
    hs_output_file output = {0};
    hs_eval_row row;
    if (!hs_path_join(study->options->out, name, path, sizeof path, err) ||
        !hs_output_open(&output, path, err))
        return false;
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
        (void)fprintf(output.file, "%s%s", i ? "," : "", hs_eval_row_head(study)[i]);
    (void)fprintf(output.file, "\n");
    for (uint32_t r = 0; r <= study->count; r++) {
        hs_eval_row_make(study, kind, r, &row);
        for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
            (void)fprintf(output.file, "%s%s", i ? "," : "", row.cell[i]);
        (void)fprintf(output.file, "\n");
    }
    if (!ferror(output.file)) return hs_output_commit(&output, err);
    hs_output_discard(&output);
    return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
}

bool hs_eval_study_tables(const hs_eval_study *study, hs_error *err) {
    return write_table(study, HS_TABLE_BEST, "best.csv", err) &&
           write_table(study, HS_TABLE_COMMON, "common.csv", err) && hs_eval_beside_table(study, err);
}
