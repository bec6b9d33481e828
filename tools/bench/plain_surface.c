/* SPDX-License-Identifier: MIT */
#include "bench/plain_surface.h"

#include "bench/plain_mean.h"
#include "smartvis_plugin.h"

#include <stdlib.h>

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
