/* SPDX-License-Identifier: MIT */
#include "bench/plain.h"

#include "smartvis_plugin.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
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

enum { MAX_FRACTION = 16, PASS_SETS = 2 };

struct plain_surface {
    bench_team *team;
    plain_points points;
    plain_maps maps;
    uint32_t *rows[BENCH_THREADS];
    uint32_t unfilled[BENCH_THREADS][PASS_SETS]; /* after even and after odd passes */
    uint32_t passes;
    float q;
    float *depth;
};

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

static void weigh_status(size_t count, const uint8_t *restrict status, uint32_t *restrict weight) {
    for (size_t i = 0; i < count; i++) weight[i] = status[i] ? PLAIN_INITIAL : 0;
}

/* Where a thread's rows begin, and those of the one before it end. */
static uint32_t first_row(const plain_surface *s, unsigned thread) {
    return s->maps.height * thread / BENCH_THREADS;
}

static void blend_rows(const plain_surface *s, unsigned thread) {
    const size_t from = (size_t)first_row(s, thread) * s->maps.width;
    const size_t to = (size_t)first_row(s, thread + 1) * s->maps.width;
    plain_blend(to - from, s->q, s->maps.surface[PLAIN_NEAR] + from, s->maps.surface[PLAIN_FAR] + from,
                s->depth + from);
}

static void touch_job(void *context, unsigned thread) {
    blend_rows(context, thread);
}

static void surface_job(void *context, unsigned thread) {
    plain_surface *s = context;
    const uint32_t y0 = first_row(s, thread), y1 = first_row(s, thread + 1);
    const size_t from = (size_t)y0 * s->maps.width, count = (size_t)(y1 - y0) * s->maps.width;
    uint32_t *const *sums = s->maps.sums[0];
    const uint8_t *status = s->points.status + from;
    weigh_status(count, status, sums[PLAIN_WEIGHT] + from);
    plain_weigh_points(count, s->maps.fraction, status, s->points.near_end + from, sums[PLAIN_NEAR] + from);
    plain_weigh_points(count, s->maps.fraction, status, s->points.far_end + from, sums[PLAIN_FAR] + from);
    bench_team_barrier(s->team);
    uint32_t pass = 0, set;
    do {
        set = pass % PASS_SETS;
        s->unfilled[thread][set] = plain_mean(&s->maps, pass++, y0, y1, s->rows[thread]);
        bench_team_barrier(s->team);
    } while (s->unfilled[0][set] + s->unfilled[1][set] > 0);
    if (thread == 0) s->passes = pass;
    blend_rows(s, thread);
}

uint32_t plain_surface_run(plain_surface *s, float q, float *depth) {
    s->q = q;
    s->depth = depth;
    bench_team_run(s->team, surface_job, s);
    return s->passes;
}

void plain_surface_touch(plain_surface *s, float q, float *depth) {
    s->q = q;
    s->depth = depth;
    bench_team_run(s->team, touch_job, s);
}

static bool allocate(plain_surface *s) {
    const size_t count = (size_t)s->maps.width * s->maps.height;
    bool ok = true;
    for (unsigned set = 0; set < 2; set++) {
        s->maps.surface[set] = calloc(count, sizeof(float));
        ok = ok && s->maps.surface[set];
        for (unsigned p = 0; p < PLAIN_PLANES; p++) {
            s->maps.sums[set][p] = calloc(count, sizeof(uint32_t));
            ok = ok && s->maps.sums[set][p];
        }
    }
    for (unsigned t = 0; t < BENCH_THREADS; t++) {
        s->rows[t] = calloc(plain_mean_row_values(s->maps.width, s->maps.k), sizeof(uint32_t));
        ok = ok && s->rows[t];
    }
    return ok;
}

plain_surface *plain_surface_create(bench_team *team, const plain_points *points, uint32_t k, hs_error *err) {
    const uint32_t fraction = plain_fraction(points->slices, k);
    if (fraction < PLAIN_MIN_FRACTION) {
        (void)hs_fail(err, HS_ERR_USAGE, "plain C: %u slices with k = %u are out of its range",
                      points->slices, k);
        return NULL;
    }
    plain_surface *s = calloc(1, sizeof *s);
    if (s) {
        s->team = team;
        s->points = *points;
        s->maps = (plain_maps){.width = points->width,
                               .height = points->height,
                               .k = k,
                               .fraction = fraction,
                               .status = points->status};
        if (allocate(s)) return s;
    }
    plain_surface_destroy(s);
    (void)hs_fail(err, HS_ERR_MEMORY, "plain C: no memory for maps of %u x %u", points->width,
                  points->height);
    return NULL;
}

void plain_surface_destroy(plain_surface *s) {
    if (!s) return;
    for (unsigned set = 0; set < 2; set++) {
        free(s->maps.surface[set]);
        for (unsigned p = 0; p < PLAIN_PLANES; p++) free(s->maps.sums[set][p]);
    }
    for (unsigned t = 0; t < BENCH_THREADS; t++) free(s->rows[t]);
    free(s);
}
