/* SPDX-License-Identifier: MIT */
/*
 * The mean filter as the kernels compute it: integer sums of fixed-point depths, one float32 division per
 * pixel. Equal to the kernels bit for bit where division is correctly rounded; within the bound of
 * docs/numerics.md of sv_ref_mean.
 */
#include "ref/ref_mean.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
    uint64_t near_sum, far_sum, weight;
} sums;

typedef struct {
    const uint8_t *initial;
    uint32_t width, height, k, weight_initial, weight_filled;
    sv_fixed format;
} filter;

static sums window_sums(const filter *f, const sums *from, uint32_t x, uint32_t y) {
    const int64_t r = f->k / 2;
    sums s = {0, 0, 0};
    for (int64_t v = y - r; v <= y + r; v++) {
        for (int64_t u = x - r; u <= x + r; u++) {
            if (u < 0 || v < 0 || u >= f->width || v >= f->height) continue;
            const sums *p = &from[(size_t)v * f->width + (size_t)u];
            s.near_sum += p->near_sum;
            s.far_sum += p->far_sum;
            s.weight += p->weight;
        }
    }
    return s;
}

/* Mean of a window: its fixed-point value, rounded to nearest even, and in float32 slices. */
static uint64_t mean_of(uint64_t sum, uint64_t weight, sv_fixed format, float *slices) {
    const uint64_t w = weight ? weight : 1;
    const float scale = 1.0f / (float)(1u << format.fraction);
    if (format.wide) {
        uint64_t rounded = (2 * sum + w) / (2 * w);
        if (rounded * 2 * w == 2 * sum + w) rounded -= rounded & 1; /* a tie: to even */
        *slices = (float)rounded * scale;
        return rounded;
    }
    const float quotient = (float)(uint32_t)sum / (float)(uint32_t)w;
    *slices = quotient * scale;
    return (uint32_t)rintf(quotient);
}

static uint32_t fixed_pass(const filter *f, const sums *from, sums *to, float *near_surface,
                           float *far_surface) {
    uint32_t empty = 0;
    for (uint32_t y = 0; y < f->height; y++)
        for (uint32_t x = 0; x < f->width; x++) {
            const size_t i = (size_t)y * f->width + x;
            const sums s = window_sums(f, from, x, y);
            const uint64_t weight = !s.weight ? 0 : f->initial[i] ? f->weight_initial : f->weight_filled;
            to[i].near_sum = weight * mean_of(s.near_sum, s.weight, f->format, &near_surface[i]);
            to[i].far_sum = weight * mean_of(s.far_sum, s.weight, f->format, &far_surface[i]);
            to[i].weight = weight;
            empty += s.weight == 0;
        }
    return empty;
}

static uint64_t to_fixed(uint32_t position, uint32_t substeps, uint32_t fraction) {
    return (((uint64_t)position << fraction) + substeps / 2) / substeps;
}

bool sv_ref_mean_fixed(const uint8_t *status, const uint32_t *near_position, const uint32_t *far_position,
                       uint32_t width, uint32_t height, uint32_t k, double omega, uint32_t substeps,
                       sv_fixed format, float *near_surface, float *far_surface, sv_ref_fill *fill) {
    const size_t count = (size_t)width * height;
    filter f = {.initial = status, .width = width, .height = height, .k = k, .format = format};
    sv_fill_weights(omega, &f.weight_initial, &f.weight_filled);
    sums *maps = calloc(2 * count, sizeof *maps);
    if (!maps) return false;
    uint32_t points = 0;
    for (size_t i = 0; i < count; i++) {
        near_surface[i] = far_surface[i] = 0.0f;
        if (!status[i]) continue;
        points++;
        maps[i].weight = f.weight_initial;
        maps[i].near_sum = f.weight_initial * to_fixed(near_position[i], substeps, format.fraction);
        maps[i].far_sum = f.weight_initial * to_fixed(far_position[i], substeps, format.fraction);
    }
    *fill = (sv_ref_fill){0, (uint32_t)count};
    uint32_t before = UINT32_MAX;
    while (points > 0 && fill->unfilled > 0 && fill->unfilled < before) {
        before = fill->passes > 0 ? fill->unfilled : UINT32_MAX;
        const size_t parity = fill->passes % 2;
        fill->unfilled =
            fixed_pass(&f, maps + parity * count, maps + (1 - parity) * count, near_surface, far_surface);
        fill->passes++;
    }
    free(maps);
    return true;
}
