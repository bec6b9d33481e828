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

/* ----------------------------------------------------------------------------------------- two methods -- */

/* A column: a measure of one way; the ratio of the two methods stands apart. */
typedef struct {
    hs_beside_way way;
    hs_measure measure;
} beside_column;

enum { NAME, FIRST, RATIO = 12, FLOOR };
static const beside_column beside_columns[HS_BESIDE_CELLS] = {[FIRST] = {HS_BESIDE_DEFAULT, HS_MEASURE_ABS},
                                                              {HS_BESIDE_DEFAULT, HS_MEASURE_FETUS_CUT},
                                                              {HS_BESIDE_KNOB, HS_MEASURE_ABS},
                                                              {HS_BESIDE_KNOB, HS_MEASURE_FETUS_CUT},
                                                              {HS_BESIDE_KNOB, HS_MEASURE_OCCLUDER_LEFT},
                                                              {HS_BESIDE_TUNED, HS_MEASURE_ABS},
                                                              {HS_BESIDE_TUNED, HS_MEASURE_FETUS_CUT},
                                                              {HS_BESIDE_TUNED, HS_MEASURE_OCCLUDER_LEFT},
                                                              {HS_BESIDE_OTHER, HS_MEASURE_ABS},
                                                              {HS_BESIDE_OTHER, HS_MEASURE_FETUS_CUT},
                                                              {HS_BESIDE_OTHER, HS_MEASURE_OCCLUDER_LEFT},
                                                              [FLOOR] = {HS_BESIDE_TRUTH, HS_MEASURE_ABS}};

/* "mean", "mean, q 0.4", "mean, tuned", "wall": who a column is about. */
static void name_way(const hs_eval_study *study, hs_beside_way way, char *out, size_t bytes) {
    const hs_eval_beside *b = &study->beside;
    if (way == HS_BESIDE_KNOB && b->knob.exists)
        (void)snprintf(out, bytes, "%.10s, %.6s %.4g", b->first_name, b->knob.info.key,
                       b->knob.value[b->best]);
    else if (way == HS_BESIDE_TUNED)
        (void)snprintf(out, bytes, "%.10s, tuned", b->first_name);
    else if (way == HS_BESIDE_TRUTH)
        (void)snprintf(out, bytes, "true surface");
    else
        (void)snprintf(out, bytes, "%.20s", way == HS_BESIDE_OTHER ? b->other_name : b->first_name);
}

static void put_head(const hs_eval_study *study, char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL]) {
    (void)snprintf(cell[NAME], HS_BESIDE_CELL, "case");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) {
        char way[36];
        if (i == RATIO) {
            (void)snprintf(cell[i], HS_BESIDE_CELL, "ratio");
            continue;
        }
        name_way(study, beside_columns[i].way, way, sizeof way);
        (void)snprintf(cell[i], HS_BESIDE_CELL, "%s: %s", way,
                       beside_columns[i].measure == HS_MEASURE_ABS         ? "e_abs"
                       : beside_columns[i].measure == HS_MEASURE_FETUS_CUT ? "cut [%]"
                                                                           : "left [%]");
    }
}

static double value_of(const hs_eval_study *study, uint32_t index, hs_beside_way way, hs_measure measure) {
    if (index >= study->count) return hs_eval_beside_mean(&study->beside, study->count, way, measure);
    return (double)study->beside.of[index][way].of[measure];
}

static void put_number(char *cell, double value) {
    if (isfinite(value))
        (void)snprintf(cell, HS_BESIDE_CELL, "%.2f", value);
    else
        (void)snprintf(cell, HS_BESIDE_CELL, "-");
}

void hs_eval_beside_row(const hs_eval_study *study, uint32_t row,
                        char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL]) {
    if (row == 0) {
        put_head(study, cell);
        return;
    }
    const uint32_t index = row - 1;
    (void)snprintf(cell[NAME], HS_BESIDE_CELL, "%.31s",
                   index < study->count ? study->space[index].name : "mean");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) {
        const beside_column c = beside_columns[i];
        if (i == RATIO)
            put_number(cell[i], value_of(study, index, HS_BESIDE_OTHER, HS_MEASURE_ABS) /
                                    value_of(study, index, HS_BESIDE_KNOB, HS_MEASURE_ABS));
        else
            put_number(cell[i],
                       value_of(study, index, c.way, c.measure) * (c.measure == HS_MEASURE_ABS ? 1 : 100));
    }
}

bool hs_eval_beside_has(const hs_eval_study *study, uint32_t column) {
    char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    for (uint32_t r = 1; r <= study->count; r++) {
        hs_eval_beside_row(study, r, cell);
        if (strcmp(cell[column], "-") != 0) return true;
    }
    return false;
}

/* To a terminal, and as "beside.csv" in the study's folder (HS_ERR_OUTPUT names the path). Nothing if there
 * is no other method. */
static void hs_eval_beside_print(const hs_eval_study *study, FILE *out) {
    char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    if (!study->beside.exists) return;
    (void)fprintf(
        out, "Beside each other, one setting for all cases; ratio: %s to %s at its best single position\n",
        study->beside.other_name, study->beside.first_name);
    hs_eval_beside_row(study, 0, cell);
    bool has[HS_BESIDE_CELLS];
    for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++) has[i] = hs_eval_beside_has(study, i);
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++)
        if (has[i]) hs_print(out, "  [%u] %s\n", i, cell[i]);
    hs_print(out, "%-6s", "case");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++)
        if (has[i]) hs_print(out, "    [%2u]", i);
    hs_print(out, "\n");
    for (uint32_t r = 1; r <= study->count + 1; r++) {
        hs_eval_beside_row(study, r, cell);
        for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++)
            if (has[i]) hs_print(out, "%*s", i ? 8 : -6, cell[i]);
        hs_print(out, "\n");
    }
    hs_print(out, "\n");
}

/* Heads are quoted because they hold commas. */
static bool hs_eval_beside_table(const hs_eval_study *study, hs_error *err) {
    char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    hs_output_file output = {0};
    if (!study->beside.exists) return true;
    if (!open_csv(study->options->out, "beside.csv", &output, err)) return false;
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        hs_eval_beside_row(study, r, cell);
        for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++)
            (void)fprintf(output.file, strchr(cell[i], ',') ? "%s\"%s\"" : "%s%s", i ? "," : "", cell[i]);
        (void)fprintf(output.file, "\n");
    }
    return hs_output_commit(&output, err); /* fails if any write before did */
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
    print_table(study, HS_TABLE_BEST, out);
    print_table(study, HS_TABLE_COMMON, out);
    hs_eval_beside_print(study, out);
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
    return write_table(study, HS_TABLE_BEST, "best.csv", err) &&
           write_table(study, HS_TABLE_COMMON, "common.csv", err) && hs_eval_beside_table(study, err);
}
