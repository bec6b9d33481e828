/* SPDX-License-Identifier: MIT */
/* Results of a parameter space as CSV files, one row per setting (docs/evaluation.md lists the columns). A
 * run that was ended goes on from them. */
#include "report/report.h"

#include "base/output_file.h"
#include "base/paths.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { T_B, DELTA, KERNEL, KNOB, OUTCOME, FIRST_MEASURE, FIELDS = FIRST_MEASURE + HS_MEASURE_COUNT };

static void write_head(const hs_eval_space *space, FILE *file) {
    (void)fprintf(file, "# %s\nt_b,delta_mi,k,%s,outcome", space->identity,
                  space->plan->knob.exists ? space->plan->knob.info.key : "position");
    for (int m = 0; m < HS_MEASURE_COUNT; m++) (void)fprintf(file, ",%s", hs_measure_key((hs_measure)m));
    (void)fprintf(file, "\n");
}

/* The rows of one item. */
static bool append(const hs_eval_space *space, uint32_t item, FILE *file) {
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
    return fflush(file) == 0 && !ferror(file);
}

/* All results so far; the file appears whole. */
static bool write_all(const hs_eval_space *space, const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (!hs_output_open(&output, path, err)) return false;
    write_head(space, output.file);
    for (uint32_t item = 0; item < space->items; item++)
        if (hs_eval_space_done(space, item)) (void)append(space, item, output.file);
    return hs_output_commit(&output, err); /* fails if any write before did */
}

/* ---------------------------------------------------------------------------------------------- load -- */

/* Splits at commas, in place; the number of fields. */
static uint32_t split(char *line, char *field[FIELDS + 1]) {
    uint32_t count = 0;
    for (char *p = line; p && count <= FIELDS; count++) {
        field[count] = p;
        p = strchr(p, ',');
        if (p) *p++ = '\0';
    }
    return count;
}

static bool number(const char *text, double *out) {
    char *end = NULL;
    *out = strtod(text, &end);
    return end != text && *end == '\0';
}

/* The position of a field's value on an axis; an axis that does not exist has an empty field. */
static bool position(const char *text, bool exists, const double *values, uint32_t count, uint32_t *out) {
    double value;
    *out = 0;
    if (!exists) return text[0] == '\0';
    if (!number(text, &value)) return false;
    while (*out < count && !(fabs(values[*out] - value) < 1e-6)) ++*out;
    return *out < count;
}

static bool take_row(hs_eval_space *space, char *line) {
    const hs_eval_plan *plan = space->plan;
    char *field[FIELDS + 1];
    uint32_t t, k, q;
    double value;
    if (split(line, field) != FIELDS ||
        !position(field[T_B], plan->threshold.exists, plan->threshold.value, plan->threshold.count, &t) ||
        !position(field[KERNEL], plan->kernel.exists, plan->kernel.value, plan->kernel.count, &k) ||
        !position(field[KNOB], plan->knob.exists, plan->knob.value, plan->knob.count, &q) ||
        !number(field[OUTCOME], &value) || !(fabs(value) < 1000))
        return false;
    const uint32_t item = t * plan->kernel.count + k;
    const sv_status outcome = (sv_status)value;
    hs_measures m;
    for (int i = 0; i < HS_MEASURE_COUNT; i++) {
        if (!number(field[FIRST_MEASURE + i], &value)) return false;
        m.of[i] = (float)value;
    }
    hs_eval_space_put(space, item, q, outcome, &m);
    return true;
}

/* Line `at` of a file: its identity, the columns' names, or a row. */
static bool take_line(hs_eval_space *space, char *line, uint32_t at, const char *path, hs_error *err) {
    if (at == 1) {
        if (line[0] == '#' && line[1] == ' ' && strcmp(line + 2, space->identity) == 0) return true;
        return hs_fail(err, HS_ERR_INPUT,
                       "%s: holds results of other settings ('%.300s', expected '# %.300s'): remove it, or "
                       "take another folder",
                       path, line, space->identity);
    }
    if (at == 2) return true;
    return take_row(space, line) ||
           hs_fail(err, HS_ERR_INPUT, "%s: line %u is no result of this parameter space", path, at);
}

static bool load_file(hs_eval_space *space, const char *path, hs_error *err) {
    char line[2048];
    FILE *file = fopen(path, "r");
    if (!file) return hs_fail(err, HS_ERR_INPUT, "%s: cannot read: %s", path, strerror(errno));
    bool ok = true;
    for (uint32_t at = 1; ok && fgets(line, sizeof line, file); at++) {
        const size_t length = strlen(line);
        if (length == 0 || line[length - 1] != '\n') {
            if (feof(file)) break; /* cut off when the run was ended */
            ok = hs_fail(err, HS_ERR_INPUT, "%s: line %u is longer than %zu characters", path, at,
                         sizeof line - 2);
            break;
        }
        line[length - 1] = '\0';
        ok = take_line(space, line, at, path, err);
    }
    if (ok && ferror(file)) ok = hs_fail(err, HS_ERR_INPUT, "%s: cannot read: %s", path, strerror(errno));
    (void)fclose(file);
    return ok;
}

static bool path_of(const hs_eval_space *space, const char *folder, char path[PATH_MAX], hs_error *err) {
    char name[96];
    (void)snprintf(name, sizeof name, "space_%s.csv", space->name);
    return hs_path_join(folder, name, path, PATH_MAX, err);
}

bool hs_eval_csv_load(hs_eval_space *space, const char *folder, hs_error *err) {
    char path[PATH_MAX];
    if (!path_of(space, folder, path, err)) return false;
    return access(path, F_OK) != 0 || load_file(space, path, err);
}

/* ------------------------------------------------------------------------------------------------ run -- */

/* The file that an item's rows are appended to, and whom to tell. */
typedef struct {
    FILE *file;
    const char *path;
    hs_progress *progress; /* may be NULL */
} rows;

static bool keep(void *context, const hs_eval_space *space, uint32_t item, hs_error *err) {
    const rows *to = context;
    if (!append(space, item, to->file))
        return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", to->path, strerror(errno));
    if (to->progress) hs_progress_step(to->progress, item + 1u);
    return true;
}

bool hs_eval_csv_run(hs_eval_space *space, hs_eval_case *c, const char *folder, hs_progress *progress,
                     hs_error *err) {
    char path[PATH_MAX];
    /* What is known already is written anew: a last line that was cut off goes. */
    if (!hs_eval_csv_load(space, folder, err) || !path_of(space, folder, path, err) ||
        !write_all(space, path, err))
        return false;
    rows to = {.file = fopen(path, "a"), .path = path, .progress = progress};
    if (!to.file) return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
    const bool ok = hs_eval_space_run(space, c, keep, &to, err);
    if (fclose(to.file) != 0 && ok)
        return hs_fail(err, HS_ERR_OUTPUT, "%s: cannot write: %s", path, strerror(errno));
    return ok;
}
