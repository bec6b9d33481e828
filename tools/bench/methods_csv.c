/* SPDX-License-Identifier: MIT */
#include "bench/methods_csv.h"

#include "base/output_file.h"
#include "ref/ref_chain.h"

static void field(FILE *file, bool known, double value) {
    if (known) (void)fprintf(file, ",%.6g", value);
    if (!known) (void)fputc(',', file);
}

static void times(FILE *file, const bench_times *t) {
    const bool known = t->median > 0.0;
    field(file, known, t->median);
    field(file, known, t->min);
    field(file, known, t->p95);
}

static void write_row(const methods_report *report, const char *section, const methods_row *r, FILE *file) {
    const methods_variant *v = r->variant;
    const methods_times *t = &r->times;
    (void)fprintf(file, "%s,\"%s\",%s,%s,%u,%u,%u,%u,%u,%u,%u,%u,%u", section, v->label,
                  sv_ref_method_name(v->method), methods_variant_precision(v), r->n, v->k, v->merge_grid,
                  v->spline_grid, methods_variant_reduction(v), r->points, t->control_points, t->passes,
                  t->frames);
    times(file, &t->end);
    times(file, &t->reconstruct);
    times(file, &t->memory);
    times(file, &t->plain);
    const double ms = methods_row_ms(r);
    field(file, t->memory.min > 0.0, ms / t->memory.min); /* a limit: the least of all frames */
    field(file, t->plain.median > 0.0, ms / t->plain.median);
    field(file, r->error.known, r->error.largest);
    field(file, r->error.known, r->error.mean);
    const methods_truth_row *truth = methods_row_truth(report, r);
    for (int s = 0; s < METHODS_SCENES; s++) /* the scenes have this size */
        field(file, truth && r->n == METHODS_SCENE_SIZE, truth ? truth->slices[s] : 0.0);
    (void)fputc('\n', file);
}

bool methods_write_csv(const methods_report *report, const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (!hs_output_open(&output, path, err)) return false;
    (void)fprintf(output.file, "section,variant,method,precision,size,k,merge_grid,spline_grid,"
                               "reduction,points,control_points,passes,frames");
    static const char *const parts[] = {"end", "reconstruct", "memory", "plain_c"};
    for (size_t p = 0; p < sizeof parts / sizeof *parts; p++)
        (void)fprintf(output.file, ",%s_median_ms,%s_min_ms,%s_p95_ms", parts[p], parts[p], parts[p]);
    (void)fprintf(output.file, ",per_memory,per_plain_c,error_max,error_mean");
    for (int s = 0; s < METHODS_SCENES; s++) (void)fprintf(output.file, ",truth_%s", methods_scene_names[s]);
    (void)fputc('\n', output.file);
    for (uint32_t i = 0; i < report->row_count; i++)
        write_row(report, "method", &report->rows[i], output.file);
    for (uint32_t i = 0; i < report->spline_count; i++)
        write_row(report, "points", &report->splines[i], output.file);
    return hs_output_commit(&output, err); /* fails if any write before did */
}
