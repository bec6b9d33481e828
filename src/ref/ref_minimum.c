/* SPDX-License-Identifier: MIT */
/* The minimum filter over sparse data, window by window (Algorithm 4.4 without its split into
 * columns and rows). */
#include "ref/ref_minimum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One pass; empty pixels are INFINITY. Returns the pixels that stay empty. */
static uint32_t minimum_pass(const double *from, uint32_t width, uint32_t height, uint32_t k, double *to) {
    const int64_t r = k / 2;
    uint32_t empty = 0;
    for (int64_t y = 0; y < height; y++)
        for (int64_t x = 0; x < width; x++) {
            double minimum = INFINITY;
            for (int64_t v = y - r; v <= y + r; v++)
                for (int64_t u = x - r; u <= x + r; u++)
                    if (u >= 0 && v >= 0 && u < width && v < height && from[v * width + u] < minimum)
                        minimum = from[v * width + u];
            to[y * width + x] = minimum;
            empty += isinf(minimum) != 0;
        }
    return empty;
}

/* `passes` passes from the map to `now`. `until_whole`: the pass after which no pixel is empty is the last.
 */
static bool minimum_passes(const sv_ref_map *map, uint32_t k, uint32_t passes, bool until_whole,
                           double *now) {
    const size_t count = (size_t)map->width * map->height;
    double *next = malloc(count * sizeof *next);
    if (!next) return false;
    uint32_t points = 0;
    for (size_t i = 0; i < count; i++) {
        now[i] = map->status[i] ? map->depth[i] : INFINITY;
        points += map->status[i] != 0;
    }
    uint32_t empty = (uint32_t)count;
    for (uint32_t n = 0; points > 0 && n < passes && (!until_whole || empty > 0); n++) {
        empty = minimum_pass(now, map->width, map->height, k, next);
        memcpy(now, next, count * sizeof *now);
    }
    free(next);
    return true;
}

/* Passes of a k x k minimum until no pixel is empty, at most `most` (0: any number). Minima round nothing, so
 * this is exact. */
static bool minimum_filter(const sv_ref_map *map, uint32_t k, uint32_t most, double *surface) {
    const size_t count = (size_t)map->width * map->height;
    if (!minimum_passes(map, k, most ? most : UINT32_MAX, true, surface)) return false;
    for (size_t i = 0; i < count; i++)
        if (isinf(surface[i])) surface[i] = 0.0;
    return true;
}

bool sv_ref_minimum_prefilter(const sv_ref_map *map, uint32_t k, uint32_t passes, double *filtered) {
    return minimum_passes(map, k, passes, false, filtered);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface) {
    return minimum_filter(&task->map, task->settings->kernel, task->settings->passes, surface);
}

/* Minima round nothing. */
static double bound(const sv_ref_task *task, const sv_ref_device *device) {
    (void)task, (void)device;
    return 0.0;
}

/* Reduced, it may pick another point altogether. */
const sv_ref_method sv_ref_method_minimum = {.bound = bound, .surface = of_task};
