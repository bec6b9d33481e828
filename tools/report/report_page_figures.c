/* SPDX-License-Identifier: MIT */
#include "report/report_page_figures.h"

#include "picture/plot.h"
#include "report/report_page_parts.h"

#include <math.h>

static void write_heat(FILE *out, const void *plot) {
    hs_plot_heat_write(out, plot);
}

static float lowest_over_knob(const hs_eval_space *space, uint32_t threshold, uint32_t kernel) {
    return hs_eval_at(space, hs_eval_best_knob(space, threshold, kernel))->of[HS_MEASURE_ABS];
}

void hs_eval_figure_space(hs_page *report, const hs_eval_study *study, uint32_t index) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_space *space = &study->space[index];
    const uint32_t kernels = plan->kernel.count;
    float value[HS_EVAL_MAX_LINE * HS_EVAL_MAX_LINE];
    double delta[HS_EVAL_MAX_LINE];
    char title[160];
    if (!plan->threshold.exists || !plan->kernel.exists) return;
    (void)snprintf(title, sizeof title, "%s: lowest e_abs over %s (as the thesis' Figure 5.7)", space->name,
                   plan->knob.exists ? plan->knob.info.key : "the knob");
    hs_plot_heat plot = {.title = title,
                         .x_label = "Delta_MI = maximum of the volume - T_B (0 .. 1)",
                         .y_label = "kernel size k (pixels)",
                         .value_label = "e_abs (DVR steps)",
                         .rows = kernels,
                         .x = delta,
                         .y = plan->kernel.value,
                         .value = value,
                         .mark_row = (int32_t)study->result[index].best.kernel};
    for (uint32_t t = plan->threshold.count; t-- > 0;) {
        /* Above the maximum there is no bone: nothing to show. */
        if (hs_eval_delta(space, t) < 0) continue;
        if (t == study->result[index].best.threshold) plot.mark_column = (int32_t)plot.columns;
        delta[plot.columns] = hs_eval_delta(space, t);
        for (uint32_t k = 0; k < kernels; k++)
            value[(size_t)plot.columns * kernels + k] = lowest_over_knob(space, t, k);
        plot.columns++;
    }
    if (plot.columns > 0) hs_eval_figure_put(report, write_heat, &plot);
}

void hs_eval_figure_mean(hs_page *report, const hs_eval_study *study) {
    const hs_eval_plan *plan = &study->plan;
    const hs_eval_mean *mean = &study->mean;
    float value[HS_EVAL_MAX_LINE * HS_EVAL_MAX_LINE];
    if (!plan->threshold.exists || !plan->kernel.exists || mean->deltas == 0) return;
    for (uint32_t i = 0; i < mean->deltas * mean->kernels; i++) {
        value[i] = INFINITY;
        for (uint32_t q = 0; q < mean->knobs; q++)
            value[i] = fminf(value[i], mean->e_abs[(size_t)i * mean->knobs + q]);
    }
    const hs_plot_heat plot = {.title =
                                   "All cases: lowest mean e_abs over the knob (as the thesis' Figure 5.8)",
                               .x_label = "Delta_MI = maximum of the volume - T_B (0 .. 1)",
                               .y_label = "kernel size k (pixels)",
                               .value_label = "mean e_abs (DVR steps)",
                               .columns = mean->deltas,
                               .rows = mean->kernels,
                               .x = mean->delta,
                               .y = plan->kernel.value,
                               .value = value,
                               .mark_column = (int32_t)mean->best,
                               .mark_row = (int32_t)mean->best_kernel};
    hs_eval_figure_put(report, write_heat, &plot);
}
