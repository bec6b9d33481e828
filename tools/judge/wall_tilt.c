/* SPDX-License-Identifier: MIT */
#include "judge/wall_tilt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NEAR_RAYS = 2, NEAR_SLICES = 3 };

/* From voxels of the turned case to those of the case: at = row . (x, y, z, 1). */
typedef struct {
    double row[3][4];
} mapping;

static mapping mapping_of(const wall_case *c, const double degrees[2]) {
    const double a = degrees[0] * acos(-1.0) / 180.0, b = degrees[1] * acos(-1.0) / 180.0;
    const double turn[3][3] = {{cos(b), sin(b) * sin(a), sin(b) * cos(a)},
                               {0.0, cos(a), -sin(a)},
                               {-sin(b), cos(b) * sin(a), cos(b) * cos(a)}};
    const double middle[3] = {0.5 * (c->nx - 1.0), 0.5 * (c->ny - 1.0), 0.5 * (c->nz - 1.0)};
    mapping m;
    for (int i = 0; i < 3; i++) {
        m.row[i][3] = middle[i];
        for (int k = 0; k < 3; k++) {
            m.row[i][k] = turn[i][k] * c->spacing_mm[k] / c->spacing_mm[i];
            m.row[i][3] -= m.row[i][k] * middle[k];
        }
    }
    return m;
}

static void map(const mapping *m, double x, double y, double z, double at[3]) {
    for (int i = 0; i < 3; i++) at[i] = m->row[i][0] * x + m->row[i][1] * y + m->row[i][2] * z + m->row[i][3];
}

/* The voxels around a place and their weights. False: not all of them were scanned. */
static bool around(const wall_case *c, const double at[3], size_t index[8], double weight[8]) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    uint32_t low[3];
    double rest[3];
    for (int i = 0; i < 3; i++) {
        if (at[i] < 0.0 || at[i] >= n[i] - 1.0) return false;
        low[i] = (uint32_t)at[i];
        rest[i] = at[i] - low[i];
    }
    for (uint32_t k = 0; k < 8; k++) {
        const size_t ray = (size_t)(low[1] + (k >> 1 & 1)) * c->nx + low[0] + (k & 1);
        const uint32_t z = low[2] + (k >> 2);
        if (z < c->first[ray] || z >= c->end[ray]) return false;
        index[k] = (size_t)z * c->nx * c->ny + ray;
        weight[k] = (k & 1 ? rest[0] : 1.0 - rest[0]) * (k & 2 ? rest[1] : 1.0 - rest[1]) *
                    (k & 4 ? rest[2] : 1.0 - rest[2]);
    }
    return true;
}

static uint8_t mix(const uint8_t *voxels, const size_t index[8], const double weight[8]) {
    double sum = 0.5;
    for (int k = 0; k < 8; k++) sum += weight[k] * voxels[index[k]];
    return (uint8_t)sum;
}

/* The voxels of a ray, in both volumes, and which were scanned. */
static void turn_ray(const wall_case *c, const mapping *m, uint32_t x, uint32_t y, wall_case *to) {
    const size_t plane = (size_t)c->nx * c->ny, ray = (size_t)y * c->nx + x;
    for (uint32_t z = 0; z < c->nz; z++) {
        double at[3], weight[8];
        size_t index[8];
        map(m, x, y, z, at);
        if (!around(c, at, index, weight)) continue;
        to->full[z * plane + ray] = mix(c->full, index, weight);
        to->clean[z * plane + ray] = mix(c->clean, index, weight);
        if (to->end[ray] == 0) to->first[ray] = (uint16_t)z;
        to->end[ray] = (uint16_t)(z + 1);
    }
}

/* What the ray of the case is that ends in this place. */
static uint8_t label_at(const wall_case *c, const double at[3]) {
    const int64_t x = (int64_t)floor(at[0] + 0.5), y = (int64_t)floor(at[1] + 0.5);
    if (x < 0 || y < 0 || x >= c->nx || y >= c->ny) return 0;
    double nearest = c->nz;
    for (int64_t v = y - NEAR_RAYS; v <= y + NEAR_RAYS; v++)
        for (int64_t u = x - NEAR_RAYS; u <= x + NEAR_RAYS; u++)
            if (u >= 0 && v >= 0 && u < c->nx && v < c->ny)
                nearest = fmin(nearest, fabs(at[2] - (double)c->truth[v * c->nx + u]));
    return nearest < NEAR_SLICES ? c->label[y * c->nx + x] : 0;
}

static bool make(const wall_case *c, wall_case *to) {
    const size_t plane = (size_t)c->nx * c->ny;
    *to = *c;
    to->full = calloc(plane, c->nz);
    to->clean = calloc(plane, c->nz);
    to->first = calloc(plane, sizeof *to->first);
    to->end = calloc(plane, sizeof *to->end);
    to->label = calloc(plane, 1);
    to->truth = calloc(plane, sizeof *to->truth);
    return to->full && to->clean && to->first && to->end && to->label && to->truth;
}

bool wall_case_tilt(wall_case *c, const double degrees[2], hs_error *err) {
    const mapping m = mapping_of(c, degrees);
    const size_t plane = (size_t)c->nx * c->ny;
    wall_case to;
    if (!make(c, &to)) {
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory to turn it", c->name);
        wall_case_free(&to);
        return false;
    }
    (void)snprintf(to.name, sizeof to.name, "%.40s %.0f,%.0f", c->name, degrees[0], degrees[1]);
    for (uint32_t y = 0; y < c->ny; y++)
        for (uint32_t x = 0; x < c->nx; x++) {
            const size_t ray = (size_t)y * c->nx + x;
            double at[3];
            turn_ray(c, &m, x, y, &to);
            to.truth[ray] = wall_termination(to.clean, plane, c->nz, ray, 0);
            map(&m, x, y, (double)to.truth[ray], at);
            if (to.end[ray] && to.truth[ray] < (float)c->nz) to.label[ray] = label_at(c, at);
        }
    wall_case_free(c);
    *c = to;
    return true;
}
