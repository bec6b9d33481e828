/* SPDX-License-Identifier: MIT */
#include "bench/methods.h"

#include "base/output_file.h"
#include "ref/ref_chain.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------ fits -- */

/* x, y > 0; values where y is 0 are left out. */
static methods_fit methods_fit_line(const double *x, const double *y, uint32_t count) {
    double sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
    methods_fit fit = {0};
    for (uint32_t i = 0; i < count; i++) {
        if (!(y[i] > 0.0)) continue;
        const double u = log(x[i]), v = log(y[i]);
        sum_x += u;
        sum_y += v;
        sum_xx += u * u;
        sum_xy += u * v;
        fit.count++;
    }
    const double n = fit.count, spread = n * sum_xx - sum_x * sum_x;
    if (fit.count < 2 || !(spread > 0.0)) return (methods_fit){.count = fit.count};
    fit.exponent = (n * sum_xy - sum_x * sum_y) / spread;
    const double constant = (sum_y - fit.exponent * sum_x) / n;
    for (uint32_t i = 0; i < count; i++)
        if (y[i] > 0.0)
            fit.factor = fmax(fit.factor, exp(fabs(log(y[i]) - constant - fit.exponent * log(x[i]))));
    return fit;
}

void methods_pareto(const double *x, const double *y, uint32_t count, bool *best) {
    for (uint32_t i = 0; i < count; i++) {
        best[i] = true;
        for (uint32_t j = 0; j < count && best[i]; j++)
            best[i] = !(x[j] <= x[i] && y[j] <= y[i] && (x[j] < x[i] || y[j] < y[i]));
    }
}

/* ------------------------------------------------------------------------------------------------ rows -- */

const uint32_t methods_spline_points[METHODS_SPLINES] = {40, 80, 160, 320, 640, 1280};

double methods_row_ms(const methods_row *row) {
    return row->times.reconstruct.median > 0.0 ? row->times.reconstruct.median : row->times.end.median;
}

const methods_truth_row *methods_row_truth(const methods_report *report, const methods_row *row) {
    for (int v = 0; v < METHODS_VARIANTS; v++)
        if (row->variant == &methods_variants[v] && report->truth[v].known) return &report->truth[v];
    return NULL;
}

double methods_truth_mean(const methods_truth_row *truth) {
    double sum = 0.0;
    for (int s = 0; s < METHODS_SCENES; s++) sum += truth->slices[s];
    return sum / METHODS_SCENES;
}

/* ------------------------------------------------------------------------------------------------- CSV -- */

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

/* ---------------------------------------------------------------------------------------------- tables -- */

static double ratio(double a, double b) {
    return b > 0.0 ? a / b : 0.0;
}

void methods_print_head(const char *what) {
    printf("\n%s; milliseconds, medians unless named; errors against float64, slices\n", what);
    printf("%-24s %4s %6s | %9s %9s %9s | %7s %8s %13s | %9s %9s\n", "variant", "ctrl", "passes", "end",
           "surface", "min", "memory", "/memory", "/plain C", "max error", "mean");
    (void)fflush(stdout);
}

void methods_print_row(const methods_row *r) {
    const methods_times *t = &r->times;
    const double ms = methods_row_ms(r);
    char control[16] = "-", plain[32] = "-", largest[16] = "left out", mean[16] = "-";
    if (t->control_points > 0) (void)snprintf(control, sizeof control, "%u", t->control_points);
    if (t->plain.median > 0.0)
        (void)snprintf(plain, sizeof plain, "%.2f (%.2f)", ratio(ms, t->plain.median),
                       ratio(t->reconstruct.min, t->plain.min));
    if (r->error.known) {
        (void)snprintf(largest, sizeof largest, "%.2e", r->error.largest);
        (void)snprintf(mean, sizeof mean, "%.2e", r->error.mean);
    }
    printf("%-24s %4s %6u | %9.3f %9.3f %9.3f | %7.4f %8.1f %13s | %9s %9s\n", r->variant->label, control,
           t->passes, t->end.median, ms, t->reconstruct.min, t->memory.min, ratio(ms, t->memory.min), plain,
           largest, mean);
    (void)fflush(stdout);
}

void methods_print_truth(const methods_report *report) {
    printf("\nScenes of %d voxels an axis: mean distance of the rays' ends from those of the ground truth, "
           "slices\n%-24s |",
           METHODS_SCENE_SIZE, "variant");
    for (int s = 0; s < METHODS_SCENES; s++) printf(" %9s", methods_scene_names[s]);
    printf(" %9s\n%-24s |", "mean", "nothing clipped");
    double sum = 0.0;
    for (int s = 0; s < METHODS_SCENES; s++) {
        printf(" %9.3f", report->unclipped[s]);
        sum += report->unclipped[s];
    }
    printf(" %9.3f\n", sum / METHODS_SCENES);
    bool refused = false;
    for (int v = 0; v < METHODS_VARIANTS; v++) {
        const methods_truth_row *truth = &report->truth[v];
        if (!truth->known) continue;
        printf("%-24s |", methods_variants[v].label);
        for (int s = 0; s < METHODS_SCENES; s++) {
            printf(" %8.3f%c", truth->slices[s], truth->clipped[s] ? ' ' : '*');
            refused = refused || !truth->clipped[s];
        }
        printf(" %9.3f\n", methods_truth_mean(truth));
    }
    if (refused) printf("* no surface: nothing is clipped\n");
    (void)fflush(stdout);
}

static void print_fit(const char *what, const char *in, methods_fit fit) {
    if (fit.count < 2) return;
    printf("%-24s | %-22s | %8.2f | %6u | %8.2f\n", what, in, fit.exponent, fit.count, fit.factor);
}

/* Filters once more by the pass: a larger map needs more of them. */
static void fit_pixels(const methods_report *report) {
    for (int v = 0; v < METHODS_VARIANTS; v++) {
        double x[BENCH_SIZES], all[BENCH_SIZES], pass[BENCH_SIZES];
        uint32_t count = 0;
        for (uint32_t i = 0; i < report->row_count; i++) {
            const methods_row *r = &report->rows[i];
            if (r->variant != &methods_variants[v] || r->times.passes == 0) continue;
            x[count] = (double)r->n * r->n;
            all[count] = methods_row_ms(r);
            pass[count] = all[count] / r->times.passes;
            count++;
        }
        print_fit(methods_variants[v].label, "pixels", methods_fit_line(x, all, count));
        if (methods_variants[v].method == SV_METHOD_MEAN || methods_variants[v].method == SV_METHOD_MINIMUM)
            print_fit(methods_variants[v].label, "pixels, a pass", methods_fit_line(x, pass, count));
    }
}

/* Once for the whole surface, once for a pass of it: a large window needs fewer passes. */
static void fit_k(const methods_report *report) {
    for (int s = 0; s < BENCH_SIZES; s++) {
        double k[METHODS_VARIANTS], all[METHODS_VARIANTS], pass[METHODS_VARIANTS];
        uint32_t count = 0;
        for (uint32_t i = 0; i < report->row_count; i++) {
            const methods_row *r = &report->rows[i];
            if (r->n != bench_sizes[s] || r->variant->method != SV_METHOD_MEAN || r->times.passes == 0 ||
                methods_variant_approximates(r->variant))
                continue;
            k[count] = r->variant->k;
            all[count] = methods_row_ms(r);
            pass[count] = all[count] / r->times.passes;
            count++;
        }
        char in[32];
        (void)snprintf(in, sizeof in, "k, at %u x %u", bench_sizes[s], bench_sizes[s]);
        print_fit("mean", in, methods_fit_line(k, all, count));
        print_fit("mean, a pass", in, methods_fit_line(k, pass, count));
    }
}

static void fit_points(const methods_report *report) {
    double x[METHODS_SPLINES], y[METHODS_SPLINES];
    const uint32_t count = report->spline_count;
    for (uint32_t i = 0; i < count; i++) {
        x[i] = report->splines[i].points;
        y[i] = methods_row_ms(&report->splines[i]);
    }
    const uint32_t few = count / 2;
    print_fit("spline, every pixel", "points", methods_fit_line(x, y, count));
    print_fit("spline, the fewer half", "points", methods_fit_line(x, y, few));
    print_fit("spline, the larger half", "points", methods_fit_line(x + few, y + few, count - few));
}

void methods_print_fits(const methods_report *report) {
    printf(
        "\nHow time grows: exponents of least-squares lines in log-log; factor: the value farthest from its "
        "line\n%-24s | %-22s | %8s | %6s | %8s\n",
        "variant", "in", "exponent", "values", "factor");
    fit_pixels(report);
    fit_k(report);
    fit_points(report);
}
