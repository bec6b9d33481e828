/* SPDX-License-Identifier: MIT */
#include "judge/site_score.h"

#include <stdio.h>

enum { TENTHS = 10, LEAST_RAYS = 100 };

void site_score_add(site_score *to, const char *name, const wall_score *score) {
    to->sum.error += score->error;
    to->sum.cut += score->cut;
    to->sum.left += score->left;
    if (to->count == 0 || score->error > to->worst) {
        to->worst = score->error;
        (void)snprintf(to->worst_name, sizeof to->worst_name, "%s", name);
    }
    to->count++;
}

wall_score site_score_mean(const site_score *s) {
    const double n = s->count ? s->count : 1.0;
    return (wall_score){s->sum.error / n, s->sum.cut / n, s->sum.left / n};
}

void site_score_print(const site_score *s, bool sure) {
    const wall_score m = site_score_mean(s);
    printf("%5.2f / %5.2f / %5.2f  worst %5.2f %-4s", m.error, 100.0 * m.cut, 100.0 * m.left, s->worst,
           s->worst_name);
    if (sure)
        printf("  AUC %.3f", wall_auc(&s->calibration));
    else
        printf("  no confidence");
    if (s->refused) printf("  %u refused", s->refused);
    printf("\n");
}

static uint64_t rays_of(const wall_calibration *t) {
    uint64_t all = 0;
    for (int i = 0; i < WALL_BINS; i++) all += t->right[i] + t->wrong[i];
    return all;
}

void site_score_print_calibration(const char *what, const wall_calibration *t) {
    uint64_t below = 0;
    printf("  %s: it says / right / share of the rays, %%\n   ", what);
    for (int i = 0; i < TENTHS; i++) {
        const double low = 0.1 * i, high = i == TENTHS - 1 ? 1.1 : 0.1 * (i + 1);
        double right, mean;
        below = 0;
        for (int k = 0; k < WALL_BINS; k++) {
            const double at = (double)k / (WALL_BINS - 1);
            if (at >= low && at < high) below += t->right[k] + t->wrong[k];
        }
        if (wall_reliability(t, low, high, LEAST_RAYS, &right, &mean))
            printf(" %.2f/%.2f/%.0f", mean, right, 100.0 * (double)below / (double)rays_of(t));
    }
    printf("\n");
}
