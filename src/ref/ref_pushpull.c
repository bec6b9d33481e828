/* SPDX-License-Identifier: MIT */
/*
 * Push-pull in float64, level by level and by recursion.
 *
 *   pull: a coarse pixel takes the weighted mean of its (up to) 2 x 2 children; its weight is the sum of
 * theirs, at most 1 push: a pixel of weight w becomes w times itself plus 1 - w times the coarse level, which
 * is linear between its pixels' centres: 3/4 of the parent and 1/4 of the parent's neighbour on the near
 * side, each way
 */
#include "ref/ref_pushpull.h"

#include <assert.h>
#include <stdlib.h>

typedef struct {
    double *value, *weight;
    uint32_t width, height;
} level;

/* Coarse pixel (x, y) from its children inside the image. */
static void pull_pixel(const level *fine, level *coarse, uint32_t x, uint32_t y) {
    double sum = 0.0, weights = 0.0;
    for (uint32_t v = 2 * y; v < 2 * y + 2 && v < fine->height; v++)
        for (uint32_t u = 2 * x; u < 2 * x + 2 && u < fine->width; u++) {
            const size_t i = (size_t)v * fine->width + u;
            sum += fine->weight[i] * fine->value[i];
            weights += fine->weight[i];
        }
    const size_t i = (size_t)y * coarse->width + x;
    coarse->value[i] = weights > 0.0 ? sum / weights : 0.0;
    coarse->weight[i] = weights < 1.0 ? weights : 1.0;
}

static void pull(const level *fine, level *coarse) {
    for (uint32_t y = 0; y < coarse->height; y++)
        for (uint32_t x = 0; x < coarse->width; x++) pull_pixel(fine, coarse, x, y);
}

/* Parent's neighbour on the side of x, or the parent at the border. */
static uint32_t beside(uint32_t x, uint32_t parents) {
    if (x % 2 == 0) return x == 0 ? 0 : x / 2 - 1;
    return x / 2 + 1 < parents ? x / 2 + 1 : x / 2;
}

static void push(level *fine, const level *coarse) {
    for (uint32_t y = 0; y < fine->height; y++)
        for (uint32_t x = 0; x < fine->width; x++) {
            const size_t i = (size_t)y * fine->width + x;
            const double *row0 = coarse->value + (size_t)(y / 2) * coarse->width;
            const double *row1 = coarse->value + (size_t)beside(y, coarse->height) * coarse->width;
            const uint32_t u0 = x / 2, u1 = beside(x, coarse->width);
            const double below = (9.0 * row0[u0] + 3.0 * row0[u1] + 3.0 * row1[u0] + row1[u1]) / 16.0;
            fine->value[i] = fine->weight[i] * fine->value[i] + (1.0 - fine->weight[i]) * below;
        }
}

static bool fill_level(level *fine) {
    assert(fine->width >= 1 && fine->height >= 1);
    if (fine->width == 1 && fine->height == 1) return true;
    level coarse = {.width = fine->width / 2 + fine->width % 2,
                    .height = fine->height / 2 + fine->height % 2};
    const size_t count = (size_t)coarse.width * coarse.height;
    double *both = calloc(2 * count, sizeof *both);
    if (!both) return false;
    coarse.value = both;
    coarse.weight = both + count;
    pull(fine, &coarse);
    const bool ok = fill_level(&coarse);
    if (ok) push(fine, &coarse);
    free(both);
    return ok;
}

bool sv_ref_pushpull(const sv_ref_map *map, double *surface) {
    const size_t count = (size_t)map->width * map->height;
    double *weight = calloc(count, sizeof *weight);
    if (!weight) return false;
    for (size_t i = 0; i < count; i++) {
        weight[i] = map->status[i] ? 1.0 : 0.0;
        surface[i] = map->status[i] ? map->depth[i] : 0.0;
    }
    level whole = {surface, weight, map->width, map->height};
    const bool ok = fill_level(&whole);
    free(weight);
    return ok;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    (void)either;
    return sv_ref_pushpull(&task->map, surface);
}

const sv_ref_method sv_ref_method_pushpull = {.name = "pushpull", .surface = of_task};
