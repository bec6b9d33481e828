/* SPDX-License-Identifier: MIT */
#include "bench/methods_report.h"

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
