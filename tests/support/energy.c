/* SPDX-License-Identifier: MIT */
#include "support/energy.h"

#include "ref/ref_grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LEVELS = 12, PROBE = 5, SMOOTHING = 5 }; /* no energy reaches further than 2 pixels */
/* The smoother's span, membrane and plate alike: Jacobi's eigenvalues lie below 4, and those of what a
 * coarser level cannot show above 0.15, about. */
static const double smallest = 0.15, largest = 4.0;

typedef struct {
    uint32_t width, height;
    double *weight, *diagonal, *x, *b, *work;
} level;

typedef struct {
    sv_ref_energy energy;
    level levels[MOST_LEVELS];
    uint32_t count;
    double damping[SMOOTHING]; /* of each step of the smoother */
} solver;

static double *numbers(size_t count) {
    double *p = calloc(count, sizeof *p);
    if (!p) abort();
    return p;
}

static size_t pixels(const level *l) {
    return (size_t)l->width * l->height;
}

/* out = A x on level n, whose pixels lie 2^n apart. */
static void apply(const solver *s, uint32_t n, const double *x, double *out) {
    const level *l = &s->levels[n];
    memset(out, 0, pixels(l) * sizeof *out);
    s->energy(x, l->width, l->height, ldexp(1.0, (int)n), out);
    for (size_t i = 0; i < pixels(l); i++) out[i] += l->weight[i] * x[i];
}

/* A's diagonal, read off by probes so far apart that they do not meet. */
static void find_diagonal(const solver *s, uint32_t n) {
    const level *l = &s->levels[n];
    for (uint32_t v = 0; v < PROBE; v++)
        for (uint32_t u = 0; u < PROBE; u++) {
            for (size_t i = 0; i < pixels(l); i++)
                l->x[i] = i % l->width % PROBE == u && i / l->width % PROBE == v;
            apply(s, n, l->x, l->work);
            for (size_t i = 0; i < pixels(l); i++)
                if (l->x[i] > 0.0) l->diagonal[i] = l->work[i];
        }
}

static void make_levels(solver *s, const sv_ref_map *map, double weight) {
    uint32_t width = map->width, height = map->height;
    for (s->count = 0; s->count < MOST_LEVELS; s->count++) {
        level *l = &s->levels[s->count];
        *l = (level){.width = width, .height = height};
        l->weight = numbers(5 * pixels(l));
        l->diagonal = l->weight + pixels(l);
        l->x = l->diagonal + pixels(l);
        l->b = l->x + pixels(l);
        l->work = l->b + pixels(l);
        const level *fine = l - 1;
        for (size_t i = 0; s->count == 0 && i < pixels(l); i++) l->weight[i] = map->status[i] ? weight : 0.0;
        for (size_t i = 0; s->count > 0 && i < pixels(fine); i++)
            l->weight[i / fine->width / 2 * width + i % fine->width / 2] += fine->weight[i];
        find_diagonal(s, s->count);
        for (size_t i = 0; s->count > 0 && i < pixels(l); i++) /* no stiffer than the surface, much */
            l->weight[i] = fmin(l->weight[i], 3.0 * (l->diagonal[i] - l->weight[i]) + 1e-9);
        if (s->count > 0) find_diagonal(s, s->count);
        if (width <= 2 && height <= 2) break;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    s->count += s->count < MOST_LEVELS;
}

/* Jacobi's steps damped by Chebyshev's roots: together the least that as many steps leave of the span. */
static void find_damping(solver *s) {
    static const double pi = 3.14159265358979323846;
    const double middle = 0.5 * (largest + smallest), half = 0.5 * (largest - smallest);
    for (int step = 0; step < SMOOTHING; step++)
        s->damping[step] = 1.0 / (middle + half * cos(pi * (step + 0.5) / SMOOTHING));
}

static void smooth(const solver *s, uint32_t n, int step) {
    const level *l = &s->levels[n];
    const double damping = s->damping[step % SMOOTHING];
    apply(s, n, l->x, l->work);
    for (size_t i = 0; i < pixels(l); i++) l->x[i] += damping * (l->b[i] - l->work[i]) / l->diagonal[i];
}

/* The four coarse pixels around fine pixel i and their shares, 9/16, 3/16, 3/16 and 1/16. */
static void around(const level *fine, const level *coarse, size_t i, size_t at[4]) {
    const size_t x = i % fine->width, y = i / fine->width, u = x / 2, v = y / 2;
    const size_t right = coarse->width - 1, below = coarse->height - 1;
    const size_t u1 = x % 2 ? (u < right ? u + 1 : u) : u - (u > 0);
    const size_t v1 = y % 2 ? (v < below ? v + 1 : v) : v - (v > 0);
    at[0] = v * coarse->width + u;
    at[1] = v * coarse->width + u1;
    at[2] = v1 * coarse->width + u;
    at[3] = v1 * coarse->width + u1;
}

/* x of level n = a symmetric cycle applied to its b. */
static void cycle(const solver *s, uint32_t n) {
    static const double share[4] = {9.0 / 16, 3.0 / 16, 3.0 / 16, 1.0 / 16};
    const level *l = &s->levels[n];
    const bool last = n + 1 == s->count;
    for (size_t i = 0; i < pixels(l); i++)
        l->x[i] = s->damping[0] * l->b[i] / l->diagonal[i]; /* a step from 0 */
    for (int step = 1; step < (last ? 8 * SMOOTHING : SMOOTHING); step++) smooth(s, n, step);
    if (last) return;
    const level *coarse = l + 1;
    size_t at[4];
    apply(s, n, l->x, l->work);
    memset(coarse->b, 0, pixels(coarse) * sizeof *coarse->b);
    for (size_t i = 0; i < pixels(l); i++) {
        around(l, coarse, i, at);
        for (int c = 0; c < 4; c++) coarse->b[at[c]] += share[c] * (l->b[i] - l->work[i]);
    }
    cycle(s, n + 1);
    for (size_t i = 0; i < pixels(l); i++) {
        around(l, coarse, i, at);
        for (int c = 0; c < 4; c++) l->x[i] += share[c] * coarse->x[at[c]];
    }
    for (int step = 0; step < SMOOTHING; step++) smooth(s, n, step);
}

static double dot(const double *a, const double *b, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

static uint32_t iterate(const solver *s, uint32_t most, double *r, double *p, double *q, double *surface) {
    const level *l = s->levels;
    const size_t count = pixels(l);
    double rz = 0.0, enough = 0.0;
    for (uint32_t step = 0; step < most; step++) {
        memcpy(l->b, r, count * sizeof *r);
        cycle(s, 0);
        const double next = dot(r, l->x, count);
        if (step == 0) enough = next * 1e-24;
        if (next <= enough) return step;
        for (size_t i = 0; i < count; i++) p[i] = l->x[i] + (step > 0 ? next / rz : 0.0) * p[i];
        rz = next;
        apply(s, 0, p, q);
        const double alpha = rz / dot(p, q, count);
        for (size_t i = 0; i < count; i++) {
            surface[i] += alpha * p[i];
            r[i] -= alpha * q[i];
        }
    }
    (void)fprintf(stderr, "energy_least: %u steps do not do\n", most);
    abort();
}

uint32_t energy_least(const sv_ref_map *map, sv_ref_energy energy, double weight, uint32_t most,
                      double *surface) {
    solver s = {.energy = energy};
    const size_t count = (size_t)map->width * map->height;
    double *r = numbers(3 * count), mean = 0.0, points = 0.0;
    find_damping(&s);
    make_levels(&s, map, weight);
    for (size_t i = 0; i < count; i++) {
        points += map->status[i] != 0;
        mean += map->status[i] ? map->depth[i] : 0.0;
    }
    for (size_t i = 0; i < count; i++) { /* from the mean: the energy does not see it */
        surface[i] = mean / points;
        r[i] = map->status[i] ? weight * (map->depth[i] - surface[i]) : 0.0;
    }
    const uint32_t steps = iterate(&s, most, r, r + count, r + 2 * count, surface);
    for (uint32_t n = 0; n < s.count; n++) free(s.levels[n].weight);
    free(r);
    return steps;
}
