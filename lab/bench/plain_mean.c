/* SPDX-License-Identifier: MIT */
#include "bench/plain.h"

#include "smartvis_plugin.h"

#include <math.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------- mean filter -- */
/*
 * The mean filter in plain C: running column sums down the rows, then windows along the row.
 * Sums are unsigned 32-bit fixed point; a difference of running sums is exact even where the
 * sums themselves wrap around.
 */

/* Rows of a thread: column sums with k / 2 zeros on either side, window sums, 1 / (sum of weights). */
static size_t padded_width(uint32_t width, uint32_t k) {
    return (size_t)width + k;
}
size_t plain_mean_row_values(uint32_t width, uint32_t k) {
    return PLAIN_PLANES * padded_width(width, k) + (PLAIN_PLANES + 1) * (size_t)width;
}

/* Every array is a parameter of its own, because the compiler heeds `restrict` there only. */
static void add_row(uint32_t width, uint32_t *restrict columns, const uint32_t *restrict row) {
    for (uint32_t x = 0; x < width; x++) columns[x] += row[x];
}
static void subtract_row(uint32_t width, uint32_t *restrict columns, const uint32_t *restrict row) {
    for (uint32_t x = 0; x < width; x++) columns[x] -= row[x];
}
static void move_row(uint32_t width, uint32_t *restrict columns, const uint32_t *restrict enters,
                     const uint32_t *restrict leaves) {
    for (uint32_t x = 0; x < width; x++) columns[x] += enters[x] - leaves[x];
}

/* Windows of k columns of the three planes, running along the row together: three chains of additions overlap
 * where one would wait for itself. Each plane has `padded` column sums; out has rows of `width`. */
static void row_windows(uint32_t width, uint32_t k, size_t padded, const uint32_t *restrict columns,
                        uint32_t *restrict out) {
    const uint32_t *restrict near_column = columns + PLAIN_NEAR * padded;
    const uint32_t *restrict far_column = columns + PLAIN_FAR * padded;
    const uint32_t *restrict weight_column = columns + PLAIN_WEIGHT * padded;
    uint32_t near_sum = 0, far_sum = 0, weight = 0;
    for (uint32_t x = 0; x < k; x++) {
        near_sum += near_column[x];
        far_sum += far_column[x];
        weight += weight_column[x];
    }
    for (uint32_t x = 0; x < width; x++) {
        out[PLAIN_NEAR * width + x] = near_sum;
        out[PLAIN_FAR * width + x] = far_sum;
        out[PLAIN_WEIGHT * width + x] = weight;
        near_sum += near_column[x + k] - near_column[x];
        far_sum += far_column[x + k] - far_column[x];
        weight += weight_column[x + k] - weight_column[x];
    }
}

/* The next pass' weights of a row, and 1 / (sum of weights). Returns the pixels without a surface. */
static uint32_t row_weights(uint32_t width, const uint32_t *restrict sum, const uint8_t *restrict status,
                            float *restrict inverse, uint32_t *restrict next) {
    uint32_t unfilled = 0;
    for (uint32_t x = 0; x < width; x++) {
        const uint32_t empty = sum[x] == 0;
        const uint32_t weight = status[x] ? PLAIN_INITIAL : PLAIN_FILLED;
        inverse[x] = 1.0f / (float)(sum[x] + empty);
        next[x] = empty ? 0 : weight;
        unfilled += empty;
    }
    return unfilled;
}

/* One end of the interval for a row: its surface in slices, and its sums for the next pass. */
static void row_surface(uint32_t width, float slices_per_unit, const uint32_t *restrict sum,
                        const float *restrict inverse, const uint32_t *restrict weight,
                        float *restrict surface, uint32_t *restrict next) {
    for (uint32_t x = 0; x < width; x++) {
        const float mean = (float)sum[x] * inverse[x];
        surface[x] = mean * slices_per_unit;
        next[x] = weight[x] * (uint32_t)rintf(mean); /* halves to even: they do not drift over many passes */
    }
}

/* Column sums of row y from those of row y - 1; row y0 is the first. */
static void step_columns(const plain_maps *m, const uint32_t *plane, uint32_t y, uint32_t y0,
                         uint32_t *columns) {
    const uint32_t r = m->k / 2;
    const bool enters = y + r<m->height, leaves = y> y0 && y > r;
    const uint32_t *enter = plane + (size_t)(y + r) * m->width;
    if (enters && leaves) move_row(m->width, columns, enter, enter - (size_t)m->k * m->width);
    if (enters && !leaves) add_row(m->width, columns, enter);
    if (!enters && leaves) subtract_row(m->width, columns, enter - (size_t)m->k * m->width);
}

uint32_t plain_mean(const plain_maps *m, uint32_t number, uint32_t y0, uint32_t y1, uint32_t *rows) {
    const uint32_t r = m->k / 2, width = m->width;
    const size_t padded = padded_width(width, m->k);
    uint32_t *columns = rows, *windows = rows + PLAIN_PLANES * padded;
    float *inverse = (float *)(windows + PLAIN_PLANES * width);
    uint32_t *const *from = m->sums[number % 2], *const *to = m->sums[1 - number % 2];
    const float slices_per_unit = 1.0f / (float)(1u << m->fraction);
    uint32_t unfilled = 0;
    memset(columns, 0, PLAIN_PLANES * padded * sizeof *columns);
    for (uint32_t p = 0; p < PLAIN_PLANES; p++)
        for (uint32_t y = y0 > r ? y0 - r : 0; y < y0 + r && y < m->height; y++)
            add_row(width, columns + p * padded + r, from[p] + (size_t)y * width);
    for (uint32_t y = y0; y < y1; y++) {
        const size_t at = (size_t)y * width;
        for (uint32_t p = 0; p < PLAIN_PLANES; p++) step_columns(m, from[p], y, y0, columns + p * padded + r);
        row_windows(width, m->k, padded, columns, windows);
        uint32_t *weight = to[PLAIN_WEIGHT] + at;
        unfilled += row_weights(width, windows + PLAIN_WEIGHT * width, m->status + at, inverse, weight);
        for (uint32_t end = PLAIN_NEAR; end <= PLAIN_FAR; end++)
            row_surface(width, slices_per_unit, windows + end * width, inverse, weight, m->surface[end] + at,
                        to[end] + at);
    }
    return unfilled;
}

/* --------------------------------------------------------------------------------------------- surface -- */

enum { MAX_FRACTION = 16 };

uint32_t plain_fraction(uint32_t slices, uint32_t k) {
    const uint64_t largest = (uint64_t)k * k * PLAIN_INITIAL * slices;
    uint32_t fraction = MAX_FRACTION;
    while (fraction > 0 &&
           (largest << fraction > UINT32_MAX || (uint64_t)slices << fraction > UINT64_C(1) << 22))
        fraction--;
    return fraction;
}

void plain_weigh_points(size_t count, uint32_t fraction, const uint8_t *restrict status,
                        const uint16_t *restrict end, uint32_t *restrict sum) {
    for (size_t i = 0; i < count; i++) {
        const uint32_t weight = status[i] == SV_POINT_INITIAL ? PLAIN_INITIAL : 0;
        sum[i] = weight * ((uint32_t)end[i] << fraction);
    }
}

void plain_blend(size_t count, float q, const float *restrict near_surface, const float *restrict far_surface,
                 float *restrict depth) {
    for (size_t i = 0; i < count; i++) depth[i] = far_surface[i] + q * (near_surface[i] - far_surface[i]);
}
