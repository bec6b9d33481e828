/* SPDX-License-Identifier: MIT */
#include "report/report.h"

#include "core/output_file.h"
#include "core/paths.h"
#include "core/system.h"
#include "core/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool open_csv(const char *folder, const char *name, hs_output_file *output, hs_error *err) {
    char path[SYS_PATH];
    return hs_path_join(folder, name, path, sizeof path, err) && hs_output_open(output, path, err);
}

/* ----------------------------------------------------------------------------------------------- space -- */

static void write_head(const hs_eval_space *space, FILE *file) {
    (void)fprintf(file, "t_b,delta_mi,k,%s,outcome",
                  space->plan->knob.exists ? space->plan->knob.info.key : "position");
    for (int m = 0; m < HS_MEASURE_COUNT; m++) (void)fprintf(file, ",%s", hs_measure_key((hs_measure)m));
    (void)fprintf(file, "\n");
}

/* The rows of one item. */
static void write_item(const hs_eval_space *space, uint32_t item, FILE *file) {
    const hs_eval_plan *plan = space->plan;
    const uint32_t t = item / plan->kernel.count, k = item % plan->kernel.count;
    for (uint32_t q = 0; q < plan->knob.count; q++) {
        if (plan->threshold.exists)
            (void)fprintf(file, "%.6g,%.4f,", plan->threshold.value[t],
                          space->volume_max - plan->threshold.value[t]);
        else
            (void)fprintf(file, ",,");
        if (plan->kernel.exists) (void)fprintf(file, "%.6g", plan->kernel.value[k]);
        (void)fprintf(file, ",");
        if (plan->knob.exists) (void)fprintf(file, "%.9g", plan->knob.value[q]);
        (void)fprintf(file, ",%d", space->outcome[item]);
        const hs_measures *m = &space->at[(size_t)item * plan->knob.count + q];
        for (int i = 0; i < HS_MEASURE_COUNT; i++) (void)fprintf(file, ",%.6g", (double)m->of[i]);
        (void)fprintf(file, "\n");
    }
}

bool hs_eval_csv_write(const hs_eval_space *space, const char *folder, hs_error *err) {
    char name[96];
    hs_output_file output = {0};
    (void)snprintf(name, sizeof name, "space_%s.csv", space->name);
    if (!open_csv(folder, name, &output, err)) return false;
    write_head(space, output.file);
    for (uint32_t item = 0; item < space->items; item++) write_item(space, item, output.file);
    return hs_output_commit(&output, err); /* fails if any write before did */
}

/* ------------------------------------------------------------------------------------------- as it is -- */

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

/* ------------------------------------------------------------------------------------------ comparison -- */

bool hs_eval_compare_table(const hs_eval_comparison *x, hs_error *err) {
    hs_output_file output = {0};
    if (!open_csv(x->options->out, "compare.csv", &output, err)) return false;
    (void)fputs("rank,method,case,seed,e_abs,e_abs_best_position,fetus_cut,occluder_left,e_abs_unclipped,"
                "map_crc32\n",
                output.file);
    for (uint32_t r = 0; r < x->count; r++) {
        const hs_eval_method *m = &x->method[x->rank[r]];
        for (uint32_t i = 0; i < x->options->case_count; i++)
            for (uint32_t s = 0; s < x->seeds; s++)
                (void)fprintf(output.file, "%u,%u,%s,%u,%.6g,%.6g,%.6g,%.6g,%.6g,%u\n", r + 1, x->rank[r] + 1,
                              x->name[i], s, (double)m->of[HS_METHOD_ABS][i][s],
                              (double)m->of[HS_METHOD_BEST][i][s], (double)m->of[HS_METHOD_CUT][i][s],
                              (double)m->of[HS_METHOD_LEFT][i][s], (double)x->unclipped[i][s],
                              m->map_crc[i][s]);
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

static const char *const heads[HS_EVAL_CELLS] = {
    "case",  "T_B",     "Delta_MI", "k",         "position", "e_abs",       "e_pos",
    "e_neg", "cut [%]", "left [%]", "unclipped", "thesis q", "thesis e_abs"};
static const char *const plain_heads[HS_PLAIN_COUNT + 1] = {
    "case", "e_abs", "cut [%]", "left [%]", "plugin [ms]", "e_abs unclipped", "true surface"};

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
    double sum = 0;
    uint32_t known = 0;
    for (uint32_t i = 0; i < study->count; i++) {
        const double of = (double)hs_eval_at(&study->space[i], setting_of(study, kind, i))->of[measure];
        if (isnan(of)) continue;
        sum += of;
        known++;
    }
    return known ? (float)(sum / known) : NAN;
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

static void make_row(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t index, hs_eval_row *row) {
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

static void make_plain_row(const hs_eval_study *study, uint32_t index, hs_eval_row *row) {
    double value[HS_PLAIN_COUNT];
    hs_eval_plain_row(study, index, value);
    (void)snprintf(row->cell[CASE], HS_EVAL_CELL, "%.31s",
                   index < study->count ? study->space[index].name : "mean");
    for (uint32_t k = 0; k < HS_PLAIN_COUNT; k++) put(row, k + 1, "%.2f", value[k]);
}

static void put_caption(const hs_eval_study *study, hs_eval_table_kind kind, char *out, size_t bytes) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_mean *mean = &study->mean;
    if (kind == HS_TABLE_PLAIN)
        (void)snprintf(out, bytes, "%s as it is", study->plain.name);
    else if (kind == HS_TABLE_BEST)
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

void hs_eval_rows_make(const hs_eval_study *study, hs_eval_table_kind kind, hs_eval_rows *out) {
    const bool plain = kind == HS_TABLE_PLAIN;
    *out = (hs_eval_rows){.rows = study->count + 2, .columns = plain ? HS_PLAIN_COUNT + 1 : HS_EVAL_CELLS};
    put_caption(study, kind, out->caption, sizeof out->caption);
    for (uint32_t r = 1; r < out->rows; r++)
        plain ? make_plain_row(study, r - 1, &out->row[r]) : make_row(study, kind, r - 1, &out->row[r]);
    for (uint32_t c = 0; c < out->columns; c++) {
        (void)snprintf(out->row[0].cell[c], HS_EVAL_CELL, "%s", plain ? plain_heads[c] : heads[c]);
        for (uint32_t r = 1; r <= study->count; r++) out->has[c] |= strcmp(out->row[r].cell[c], "-") != 0;
    }
}

/* ------------------------------------------------------------------------------------------- outputs -- */

static void print_table(const hs_eval_rows *t, FILE *out) {
    int width[HS_EVAL_CELLS] = {0};
    for (uint32_t r = 0; r < t->rows; r++)
        for (uint32_t c = 0; c < t->columns; c++)
            if ((int)strlen(t->row[r].cell[c]) > width[c]) width[c] = (int)strlen(t->row[r].cell[c]);
    hs_print(out, "%s\n", t->caption);
    for (uint32_t r = 0; r < t->rows; r++) {
        hs_print(out, "%-*s", width[CASE], t->row[r].cell[CASE]);
        for (uint32_t c = 1; c < t->columns; c++)
            if (t->has[c]) hs_print(out, "%*s", width[c] + 2, t->row[r].cell[c]);
        hs_print(out, "\n");
    }
    hs_print(out, "\n");
}

void hs_eval_study_print(const hs_eval_study *study, FILE *out) {
    hs_eval_rows table;
    for (int kind = HS_TABLE_PLAIN; kind <= HS_TABLE_COMMON; kind++) {
        hs_eval_rows_make(study, (hs_eval_table_kind)kind, &table);
        print_table(&table, out);
    }
}

bool hs_eval_study_tables(const hs_eval_study *study, hs_error *err) {
    static const char *const names[] = {"plain.csv", "best.csv", "common.csv"};
    hs_eval_rows table;
    for (int kind = HS_TABLE_PLAIN; kind <= HS_TABLE_COMMON; kind++) {
        hs_output_file output = {0};
        if (!open_csv(study->options->out, names[kind], &output, err)) return false;
        hs_eval_rows_make(study, (hs_eval_table_kind)kind, &table);
        for (uint32_t r = 0; r < table.rows; r++)
            for (uint32_t c = 0; c < table.columns; c++)
                hs_print(output.file, "%s%s", table.row[r].cell[c], c + 1 < table.columns ? "," : "\n");
        if (!hs_output_commit(&output, err)) return false; /* fails if any write before did */
    }
    return true;
}
