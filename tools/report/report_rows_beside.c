/* SPDX-License-Identifier: MIT */
#include "report/report_rows_beside.h"

#include "base/output_file.h"
#include "base/paths.h"
#include "base/text.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* A column: a measure of one way; the ratio of the two methods stands apart. */
typedef struct {
    hs_beside_way way;
    hs_measure measure;
} column;

enum { CASE, FIRST, RATIO = 12, FLOOR };
static const column columns[HS_BESIDE_CELLS] = {[FIRST] = {HS_BESIDE_DEFAULT, HS_MEASURE_ABS},
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

/* "mean", "mean, q 0.4", "mean, tuned", "cost": who a column is about. */
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
    (void)snprintf(cell[CASE], HS_BESIDE_CELL, "case");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) {
        char way[36];
        if (i == RATIO) {
            (void)snprintf(cell[i], HS_BESIDE_CELL, "ratio");
            continue;
        }
        name_way(study, columns[i].way, way, sizeof way);
        (void)snprintf(cell[i], HS_BESIDE_CELL, "%s: %s", way,
                       columns[i].measure == HS_MEASURE_ABS         ? "e_abs"
                       : columns[i].measure == HS_MEASURE_FETUS_CUT ? "cut [%]"
                                                                    : "left [%]");
    }
}

static double value_of(const hs_eval_study *study, uint32_t index, hs_beside_way way, hs_measure measure) {
    if (index >= study->count) return hs_eval_beside_mean(&study->beside, study->count, way, measure);
    return (double)study->beside.of[index][way].of[measure];
}

static void put(char *cell, double value) {
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
    (void)snprintf(cell[CASE], HS_BESIDE_CELL, "%.31s",
                   index < study->count ? study->space[index].name : "mean");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) {
        const column c = columns[i];
        if (i == RATIO)
            put(cell[i], value_of(study, index, HS_BESIDE_OTHER, HS_MEASURE_ABS) /
                             value_of(study, index, HS_BESIDE_KNOB, HS_MEASURE_ABS));
        else
            put(cell[i], value_of(study, index, c.way, c.measure) * (c.measure == HS_MEASURE_ABS ? 1 : 100));
    }
}

void hs_eval_beside_print(const hs_eval_study *study, FILE *out) {
    char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    if (!study->beside.exists) return;
    (void)fprintf(out,
                  "Beside each other, one setting for all cases; ratio: %s to %s at its best single knob\n",
                  study->beside.other_name, study->beside.first_name);
    hs_eval_beside_row(study, 0, cell);
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) hs_print(out, "  [%u] %s\n", i, cell[i]);
    hs_print(out, "%-6s", "case");
    for (uint32_t i = FIRST; i < HS_BESIDE_CELLS; i++) hs_print(out, "    [%2u]", i);
    hs_print(out, "\n");
    for (uint32_t r = 1; r <= study->count + 1; r++) {
        hs_eval_beside_row(study, r, cell);
        for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++) hs_print(out, "%*s", i ? 8 : -6, cell[i]);
        hs_print(out, "\n");
    }
    hs_print(out, "\n");
}

/* Heads hold commas: quoted. */
bool hs_eval_beside_table(const hs_eval_study *study, hs_error *err) {
    char path[PATH_MAX], cell[HS_BESIDE_CELLS][HS_BESIDE_CELL];
    hs_output_file output = {0};
    if (!study->beside.exists) return true;
    if (!hs_path_join(study->options->out, "beside.csv", path, sizeof path, err) ||
        !hs_output_open(&output, path, err))
        return false;
    for (uint32_t r = 0; r <= study->count + 1; r++) {
        hs_eval_beside_row(study, r, cell);
        for (uint32_t i = 0; i < HS_BESIDE_CELLS; i++)
            (void)fprintf(output.file, strchr(cell[i], ',') ? "%s\"%s\"" : "%s%s", i ? "," : "", cell[i]);
        (void)fprintf(output.file, "\n");
    }
    if (!ferror(output.file)) return hs_output_commit(&output, err);
    hs_output_discard(&output);
    return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
}
