/* SPDX-License-Identifier: MIT */
#include "bench/methods_fit.h"

#include <math.h>

methods_fit methods_fit_line(const double *x, const double *y, uint32_t count) {
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
