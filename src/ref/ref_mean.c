/* SPDX-License-Identifier: MIT */
/* The mean filter in float64, by its definition: a window is summed pixel by pixel (Eq.
 * 3.18-3.21, Algorithm 4.3). */
#include "ref/ref_mean.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const uint8_t *initial;
    uint32_t width, height, k;
    double omega;
} filter;

/* The weighted mean of the window around (x, y); false if nothing in it has weight. Pixels outside
 * do not count. */
static bool window_mean(const filter *f, const double *depth, const uint8_t *filled, uint32_t x, uint32_t y,
                        double *mean) {
    const int64_t r = f->k / 2;
    double sum = 0.0, weights = 0.0;
    for (int64_t v = y - r; v <= y + r; v++) {
        for (int64_t u = x - r; u <= x + r; u++) {
            if (u < 0 || v < 0 || u >= f->width || v >= f->height) continue;
            const size_t i = (size_t)v * f->width + (size_t)u;
            const double weight = f->initial[i] ? 1.0 : filled[i] ? f->omega : 0.0;
            sum += weight * depth[i];
            weights += weight;
        }
    }
    *mean = weights > 0.0 ? sum / weights : 0.0;
    return weights > 0.0;
}

/* One pass from (depth, filled) to (next, next_filled). Returns the pixels that stay empty. */
static uint32_t mean_pass(const filter *f, const double *depth, const uint8_t *filled, double *next,
                          uint8_t *next_filled) {
    uint32_t empty = 0;
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            const size_t i = (size_t)y * f->width + x;
            next_filled[i] = window_mean(f, depth, filled, x, y, &next[i]);
            empty += !next_filled[i];
        }
    return empty;
}

bool sv_ref_mean(const uint8_t *status, const double *depth, uint32_t width, uint32_t height, uint32_t k,
                 double omega, double *surface, sv_ref_fill *fill) {
    const size_t count = (size_t)width * height;
    const filter f = {status, width, height, k, omega};
    double *now = malloc(count * sizeof *now);
    uint8_t *filled = malloc(2 * count);
    if (!now || !filled) {
        free(now);
        free(filled);
        return false;
    }
    uint32_t empty = 0;
    for (size_t i = 0; i < count; i++) {
        filled[i] = status[i] != 0;
        now[i] = filled[i] ? depth[i] : 0.0;
        surface[i] = 0.0;
        empty += !filled[i];
    }
    *fill = (sv_ref_fill){0, empty};
    uint32_t before = empty == count ? 0 : UINT32_MAX; /* without a point there is nothing to do */
    while (before > 0 && (fill->passes == 0 || fill->unfilled > 0)) {
        fill->unfilled = mean_pass(&f, now, filled, surface, filled + count);
        fill->passes++;
        memcpy(now, surface, count * sizeof *now);
        memcpy(filled, filled + count, count);
        if (fill->unfilled == before) break; /* omega = 0: no pass will reach the rest */
        before = fill->unfilled;
    }
    free(now);
    free(filled);
    return true;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface) {
    const sv_ref_map *m = &task->map;
    sv_ref_fill fill;
    return sv_ref_mean(m->status, m->depth, m->width, m->height, task->settings->kernel,
                       task->settings->fill_weight, surface, &fill);
}

/* Fixed-point formats are chosen to keep a thousandth of a slice. */
static double bound(const sv_ref_task *task, const sv_ref_device *device) {
    (void)task, (void)device;
    return 1e-3;
}

const sv_ref_method sv_ref_method_mean = {.bound = bound, .surface = of_task};
