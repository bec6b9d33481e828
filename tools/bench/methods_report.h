/* SPDX-License-Identifier: MIT */
/* The results of sv_surfaces_bench. */
#ifndef METHODS_REPORT_H
#define METHODS_REPORT_H

#include "bench/bench.h"
#include "bench/methods_reference.h"
#include "bench/methods_time.h"
#include "bench/methods_truth.h"

enum { METHODS_SPLINES = 6, METHODS_ROWS = BENCH_SIZES * METHODS_VARIANTS };
extern const uint32_t methods_spline_points[METHODS_SPLINES]; /* of the fit in the number of points */

/* One variant at one size. */
typedef struct {
    const methods_variant *variant;
    uint32_t n, points; /* pixels across; initial points */
    methods_times times;
    methods_error error; /* against float64 */
} methods_row;

/* One variant's pictures, means of slices. */
typedef struct {
    bool known;
    double slices[METHODS_SCENES];
    bool clipped[METHODS_SCENES];
} methods_truth_row;

typedef struct {
    bench_machine machine;
    methods_row rows[METHODS_ROWS];
    uint32_t row_count;
    methods_row splines[METHODS_SPLINES]; /* unmerged, every pixel, at the smallest size */
    uint32_t spline_count;
    methods_truth_row truth[METHODS_VARIANTS];
    double unclipped[METHODS_SCENES];
} methods_report;

/* A row's time, ms: the reconstruct stage, or `end` if the plugin has no stage times. */
double methods_row_ms(const methods_row *row);

/* The truth of a row's variant, or NULL. */
const methods_truth_row *methods_row_truth(const methods_report *report, const methods_row *row);
/* Mean over the scenes. */
double methods_truth_mean(const methods_truth_row *truth);

#endif
