/* SPDX-License-Identifier: MIT */
/*
 * The mean filter as the kernels compute it: integer sums of fixed-point depths, one float32 division per
 * pixel. Equal to the kernels bit for bit where division is correctly rounded; within the bound of
 * docs/numerics.md of sv_ref_mean.
 */
#include "ref/sv_ref.h"

#include <math.h>
#include <stdlib.h>

#define MAX_FRACTION 16 /* 32-bit sums: 1 / 65,536 slice */
#define MIN_FRACTION 10 /* below this 32-bit sums are too coarse for the bound of 1e-3 slice */
#define QUOTIENT_BITS                                                                                        \
    23               /* 32-bit sums: fixed-point depths stay below 2^23, where a float32 still knows halves */
#define PROMISE 1e-3 /* slices: the largest error against float64 */
#define WIDE_FRACTION                                                                                        \
    20 /* 64-bit sums: 13 bits of slices and 14 of weights leave room for more, float32 does not */

void sv_ref_weights(double omega, uint32_t *weight_initial, uint32_t *weight_filled) {
    uint32_t quarters = (uint32_t)(omega * 4.0 + 0.5), whole = 4;
    while (whole > 1 && quarters % 2 == 0) {
        quarters /= 2;
        whole /= 2;
    }
    *weight_initial = whole;
    *weight_filled = quarters;
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

uint32_t sv_ref_pass_limit(uint32_t width, uint32_t height, uint32_t k) {
    const uint32_t longest = width > height ? width : height;
    const uint32_t limit = (longest - 1 + k / 2 - 1) / (k / 2);
    return limit < 3 ? 3 : limit;
}

/* Every pass rounds to half a unit. Windows of 7 x 7 and more average that away; in smaller ones it was seen
 * to add up to an eighth of passes * half a unit (docs/numerics.md). */
static bool drifts(uint32_t k, uint32_t passes, uint32_t fraction) {
    return k < 7 && passes / 8.0 * 0.5 / (1u << fraction) > PROMISE;
}

sv_ref_fixed sv_ref_fixed_format(uint32_t width, uint32_t height, uint32_t slices, uint32_t k,
                                 uint32_t weight_initial) {
    const uint64_t depth = slices > 1 ? slices - 1 : 1;
    const uint64_t window = (uint64_t)smaller(k, width) * smaller(k, height) * weight_initial;
    uint32_t fraction = MAX_FRACTION;
    while (fraction > 0 &&
           (window * (depth << fraction) > UINT32_MAX || (depth << fraction) >= 1u << QUOTIENT_BITS))
        fraction--;
    if (fraction < MIN_FRACTION || drifts(k, sv_ref_pass_limit(width, height, k), fraction))
        return (sv_ref_fixed){.fraction = WIDE_FRACTION, .wide = true};
    return (sv_ref_fixed){.fraction = fraction};
}

sv_ref_fixed sv_ref_half_format(uint32_t slices, uint32_t weight_initial) {
    const uint32_t depth = (slices > 1 ? slices - 1 : 1) * weight_initial;
    uint32_t fraction = 0;
    while (fraction < MAX_FRACTION && depth << (fraction + 1) <= UINT16_MAX) fraction++;
    return (sv_ref_fixed){.fraction = fraction, .half = true};
}

typedef struct {
    uint64_t near_sum, far_sum, weight;
} sums;

typedef struct {
    const uint8_t *initial;
    uint32_t width, height, k, weight_initial, weight_filled;
    sv_ref_fixed format;
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
static uint64_t mean_of(uint64_t sum, uint64_t weight, sv_ref_fixed format, float *slices) {
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
                       sv_ref_fixed format, float *near_surface, float *far_surface, sv_ref_fill *fill) {
    const size_t count = (size_t)width * height;
    filter f = {.initial = status, .width = width, .height = height, .k = k, .format = format};
    sv_ref_weights(omega, &f.weight_initial, &f.weight_filled);
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
