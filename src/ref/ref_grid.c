/* SPDX-License-Identifier: MIT */
/* The surface of least energy: conjugate gradients in float64 on A S = b, with no preconditioner to
 * be wrong about. */
#include "ref/ref_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double dot(const double *a, const double *b, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) sum += a[i] * b[i];
    return sum;
}

static double weight_of(const sv_ref_map *map, double weight, size_t i) {
    return !map->status[i] ? 0.0 : map->weight ? weight * map->weight[i] : weight;
}

/* out = A s. */
static void apply(const sv_ref_map *map, sv_ref_energy energy, double weight, const double *s, double *out) {
    const size_t count = (size_t)map->width * map->height;
    memset(out, 0, count * sizeof *out);
    energy(s, map->width, map->height, map->spacing ? map->spacing : 1.0, out);
    for (size_t i = 0; i < count; i++) out[i] += weight_of(map, weight, i) * s[i];
}

bool sv_ref_least_energy(const sv_ref_map *map, sv_ref_energy energy, double weight, double *surface) {
    const size_t count = (size_t)map->width * map->height;
    double *r = malloc(3 * count * sizeof *r), *p = r + count, *q = p + count;
    if (!r) return false;
    for (size_t i = 0; i < count; i++) {
        r[i] = p[i] = map->status[i] ? weight_of(map, weight, i) * map->depth[i] : 0.0;
        surface[i] = 0.0;
    }
    double rr = dot(r, r, count);
    const double enough = rr * 1e-26;
    for (size_t step = 0; rr > enough && step < 40 * count + 1000; step++) {
        apply(map, energy, weight, p, q);
        const double alpha = rr / dot(p, q, count);
        for (size_t i = 0; i < count; i++) {
            surface[i] += alpha * p[i];
            r[i] -= alpha * q[i];
        }
        const double next = dot(r, r, count);
        for (size_t i = 0; i < count; i++) p[i] = r[i] + next / rr * p[i];
        rr = next;
    }
    free(r);
    return true;
}
