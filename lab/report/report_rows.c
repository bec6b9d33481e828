/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static bool open_csv(const char *folder, const char *name, hs_output_file *output, hs_error *err) {
    char path[PATH_MAX];
    return hs_path_join(folder, name, path, sizeof path, err) && hs_output_open(output, path, err);
}

/* ------------------------------------------------------------------------------------------- as it is -- */

const char *const hs_eval_plain_head[HS_PLAIN_COUNT] = {"e_abs",       "cut [%]",         "left [%]",
                                                        "plugin [ms]", "e_abs unclipped", "true surface"};

static void case_row(const hs_eval_study *study, uint32_t index, double out[HS_PLAIN_COUNT]) {
    const hs_measures *m = &study->plain.of[index];
    out[HS_PLAIN_ABS] = (double)m->of[HS_MEASURE_ABS];
    out[HS_PLAIN_CUT] = 100 * (double)m->of[HS_MEASURE_FETUS_CUT];
    out[HS_PLAIN_LEFT] = 100 * (double)m->of[HS_MEASURE_OCCLUDER_LEFT];
    out[HS_PLAIN_MS] = study->plain.ms[index];
    out[HS_PLAIN_UNCLIPPED] = (double)study->result[index].unclipped.of[HS_MEASURE_ABS];
    out[HS_PLAIN_FLOOR] = study->plain.floor[index];
}

void hs_eval_plain_row(const hs_eval_study *study, uint32_t index, double out[HS_PLAIN_COUNT]) {
    double row[HS_PLAIN_COUNT];
    if (index < study->count) {
        case_row(study, index, out);
        return;
    }
    for (int k = 0; k < HS_PLAIN_COUNT; k++) {
        uint32_t known = 0;
        double sum = 0;
        for (uint32_t i = 0; i < study->count; i++) {
            case_row(study, i, row);
            if (isnan(row[k])) continue;
            sum += row[k];
            known++;
        }
        out[k] = known ? sum / known : (double)NAN;
    }
}

uint32_t hs_eval_plain_worst(const hs_eval_study *study, int column, double *out) {
    double row[HS_PLAIN_COUNT];
    uint32_t worst = study->count;
    *out = -INFINITY;
    for (uint32_t i = 0; i < study->count; i++) {
        case_row(study, i, row);
        if (!(row[column] > *out)) continue;
        *out = row[column];
        worst = i;
    }
    return worst;
}

/* A head, a line a case, the means: in columns, or parted by commas. */
static void write_plain(const hs_eval_study *study, FILE *out, bool csv) {
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        double row[HS_PLAIN_COUNT];
        const char *name = r == 0 ? "case" : r <= study->count ? study->space[r - 1].name : "mean";
        if (r > 0) hs_eval_plain_row(study, r - 1, row);
        hs_print(out, csv ? "%s" : "%-6s", name);
        for (int k = 0; k < HS_PLAIN_COUNT; k++) {
            char text[32] = "-";
            if (r > 0 && !isnan(row[k])) (void)snprintf(text, sizeof text, "%.2f", row[k]);
            hs_print(out, csv ? ",%s" : "%17s", r == 0 ? hs_eval_plain_head[k] : text);
        }
        hs_print(out, "\n");
    }
}

/* ------------------------------------------------------------------------------------------ comparison -- */

bool hs_eval_compare_table(const hs_eval_comparison *x, hs_error *err) {
    hs_output_file output = {0};
    if (!open_csv(x->options->out, "compare.csv", &output, err)) return false;
    (void)fprintf(
        output.file,
        "rank,method,case,seed,e_abs,e_abs_best_position,fetus_cut,occluder_left,e_abs_unclipped\n");
    for (uint32_t r = 0; r < x->count; r++) {
        const hs_eval_method *m = &x->method[x->rank[r]];
        for (uint32_t i = 0; i < x->options->case_count; i++)
            for (uint32_t s = 0; s < x->seeds; s++)
                (void)fprintf(output.file, "%u,%u,%s,%u,%.6g,%.6g,%.6g,%.6g,%.6g\n", r + 1, x->rank[r] + 1,
                              x->name[i], s, (double)m->of[HS_METHOD_ABS][i][s],
                              (double)m->of[HS_METHOD_BEST][i][s], (double)m->of[HS_METHOD_CUT][i][s],
                              (double)m->of[HS_METHOD_LEFT][i][s], (double)x->unclipped[i][s]);
    }
    return hs_output_commit(&output, err); /* fails if any write before did */
}

void hs_eval_compare_print(const hs_eval_comparison *x, FILE *out) {
    hs_print(out, "%4s %8s %13s %14s %18s  method\n", "rank", "e_abs", "best position", "fetus cut [%]",
             "occluder left [%]");
    for (uint32_t r = 0; r < x->count; r++) {
        const uint32_t m = x->rank[r];
        hs_print(out, "%4u %8.2f %13.2f %14.2f %18.2f  %s\n", r + 1, hs_eval_method_mean(x, m, HS_METHOD_ABS),
                 hs_eval_method_mean(x, m, HS_METHOD_BEST), 100 * hs_eval_method_mean(x, m, HS_METHOD_CUT),
                 100 * hs_eval_method_mean(x, m, HS_METHOD_LEFT), x->method[m].label);
    }
}

/* ---------------------------------------------------------------------------------------------- tables -- */

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
        "case",  "T_B",     "Delta_MI", "k",         "position", "e_abs",       "e_pos",
        "e_neg", "cut [%]", "left [%]", "unclipped", "thesis q", "thesis e_abs"};
    return head;
}

static void put(hs_eval_row *row, uint32_t column, const char *format, double value) {
    if (isnan(value))
        (void)snprintf(row->cell[column], HS_EVAL_CELL, "-");
    else
        (void)snprintf(row->cell[column], HS_EVAL_CELL, format, value);
}

static hs_eval_setting setting_of(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t index) {
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
            const float of = hs_eval_at(&study->space[i], setting_of(study, kind, i))->of[measure];
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
    const hs_eval_setting setting = setting_of(study, kind, index);
    (void)snprintf(row->cell[CASE], HS_EVAL_CELL, "%.31s", space->name);
    put(row, THRESHOLD, "%.2f", plan->threshold.exists ? plan->threshold.value[setting.threshold] : NAN);
    put(row, DELTA, "%.2f", hs_eval_delta(space, setting.threshold));
    put(row, KERNEL, "%.0f", plan->kernel.exists ? plan->kernel.value[setting.kernel] : NAN);
    put(row, KNOB, "%.4g", plan->knob.exists ? plan->knob.value[setting.knob] : NAN);
    put_measures(row, hs_eval_at(space, setting), (double)study->result[index].unclipped.of[HS_MEASURE_ABS]);
    if (!t) return;
    put(row, THESIS_KNOB, "%.2f", kind == HS_TABLE_BEST ? t->knob : t->common_knob);
    put(row, THESIS_E_ABS, "%.2f", kind == HS_TABLE_BEST ? t->e_abs : t->common_e_abs);
}

bool hs_eval_row_has(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t column) {
    hs_eval_row row;
    for (uint32_t r = 0; r < study->count; r++) {
        hs_eval_row_make(study, kind, r, &row);
        if (strcmp(row.cell[column], "-") != 0) return true;
    }
    return false;
}

void hs_eval_row_caption(const hs_eval_study *study, hs_eval_table_kind kind, char *out, size_t bytes) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_mean *mean = &study->mean;
    if (kind == HS_TABLE_BEST)
        (void)snprintf(out, bytes, "Each case's setting with the lowest e_abs (thesis, Table 5.2)");
    else if (!plan->threshold.exists || !plan->kernel.exists)
        (void)snprintf(out, bytes, "Each case's best surface position");
    else if (mean->deltas == 0)
        (void)snprintf(out, bytes, "The cases have no Delta_MI in common: each case's own best setting");
    else
        (void)snprintf(
            out, bytes,
            "Delta_MI = %.2f and k = %.0f for all cases, each case's best position (thesis, Table "
            "5.3); with one position for all, %.4g, the mean e_abs is %.2f",
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
    bool has[HS_EVAL_CELLS];
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++) {
        has[i] = hs_eval_row_has(study, kind, i);
        if (has[i]) hs_print(out, "%*s", widths[i], hs_eval_row_head(study)[i]);
    }
    (void)fprintf(out, "\n");
    for (uint32_t r = 0; r <= study->count; r++) {
        hs_eval_row_make(study, kind, r, &row);
        for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
            if (has[i]) hs_print(out, "%*s", widths[i], row.cell[i]);
        (void)fprintf(out, "\n");
    }
    (void)fprintf(out, "\n");
}

void hs_eval_study_print(const hs_eval_study *study, FILE *out) {
    hs_print(out, "%s as it is\n", study->plain.name);
    write_plain(study, out, false);
    hs_print(out, "\n");
    print_table(study, HS_TABLE_BEST, out);
    print_table(study, HS_TABLE_COMMON, out);
}

static bool write_table(const hs_eval_study *study, hs_eval_table_kind kind, const char *name,
                        hs_error *err) {
    hs_output_file output = {0};
    hs_eval_row row;
    if (!open_csv(study->options->out, name, &output, err)) return false;
    for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
        (void)fprintf(output.file, "%s%s", i ? "," : "", hs_eval_row_head(study)[i]);
    (void)fprintf(output.file, "\n");
    for (uint32_t r = 0; r <= study->count; r++) {
        hs_eval_row_make(study, kind, r, &row);
        for (uint32_t i = 0; i < HS_EVAL_CELLS; i++)
            (void)fprintf(output.file, "%s%s", i ? "," : "", row.cell[i]);
        (void)fprintf(output.file, "\n");
    }
    return hs_output_commit(&output, err); /* fails if any write before did */
}

bool hs_eval_study_tables(const hs_eval_study *study, hs_error *err) {
    hs_output_file output = {0};
    if (!open_csv(study->options->out, "plain.csv", &output, err)) return false;
    write_plain(study, output.file, true);
    return hs_output_commit(&output, err) && write_table(study, HS_TABLE_BEST, "best.csv", err) &&
           write_table(study, HS_TABLE_COMMON, "common.csv", err);
}
