/* SPDX-License-Identifier: MIT */
#include "judge/site_variant.h"

#include "base/paths.h"
#include "eval/eval_case.h"
#include "scene/scene.h"
#include "volume/metaimage_write.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FLUID_LEVEL = 40, POOL = 65536, LEAST_POOL = 64, NEAR = 3, FAR = 8, LEAD = 16, NOISE = 24 };
/* Half a bladder's width, and how much of the tissue between it and the true surface stays: it lies on the
 * wall of the sac, and never in the sac or the fetus. */
static const double bladder_mm = 20.0, between_mm = 5.0;

const char *site_variant_name(site_variant kind) {
    static const char *const text[] = {"bare, noisy fluid", "bare, black fluid", "no fetus", "bladder"};
    return text[kind];
}

const char *site_bare_view_name(site_bare_view kind) {
    static const char *const text[] = {"scanned ranges given", "no ranges", "behind noisy fluid",
                                       "behind black fluid"};
    return text[kind];
}

/* Numerical Recipes' constants: the same noise on every machine. */
static uint32_t next(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static size_t plane_of(const wall_case *c) {
    return (size_t)c->nx * c->ny;
}

/* A case with room for everything, `lead` slices longer than `from`; all zeros. */
static bool make_like(const wall_case *from, uint32_t lead, wall_case *out, hs_error *err) {
    const size_t plane = plane_of(from), count = plane * (from->nz + lead);
    *out = (wall_case){.nx = from->nx, .ny = from->ny, .nz = from->nz + lead};
    memcpy(out->name, from->name, sizeof out->name);
    memcpy(out->spacing_mm, from->spacing_mm, sizeof out->spacing_mm);
    out->full = calloc(count, 1);
    out->clean = calloc(count, 1);
    out->first = calloc(plane, sizeof *out->first);
    out->end = calloc(plane, sizeof *out->end);
    out->label = calloc(plane, 1);
    out->truth = calloc(plane, sizeof *out->truth);
    if (out->full && out->clean && out->first && out->end && out->label && out->truth) return true;
    wall_case_free(out);
    return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a variant of %zu voxels", from->name, count);
}

/* The fetus is whatever can be seen; its truth is the volume as it is. */
static void nothing_hides(wall_case *c, bool relabel) {
    const size_t plane = plane_of(c);
    memcpy(c->clean, c->full, plane * c->nz);
    for (size_t i = 0; i < plane; i++) {
        c->truth[i] = wall_termination(c->full, plane, c->nz, i, 0);
        if (relabel) c->label[i] = c->truth[i] < (float)c->nz ? HS_LABEL_FETUS : HS_LABEL_NEITHER;
    }
}

/* ---- from a case with a truth */

/* Levels of fluid just before the surface. */
static size_t find_fluid(const wall_case *c, uint8_t pool[POOL]) {
    size_t count = 0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->label[i] == HS_LABEL_NEITHER) continue;
        for (uint32_t back = NEAR; back <= FAR && count < POOL; back++) {
            const int64_t z = (int64_t)c->truth[i] - back;
            if (z < c->first[i] || z >= c->end[i]) continue;
            const uint8_t level = c->full[(size_t)z * plane_of(c) + i];
            if (level < FLUID_LEVEL) pool[count++] = level;
        }
    }
    return count;
}

/* Where the truth begins: removed voxels are 0 or 1. */
static uint32_t clip_of(const wall_case *c, size_t pixel) {
    uint32_t z = c->first[pixel];
    while (z < c->end[pixel] && c->clean[z * plane_of(c) + pixel] <= 1) z++;
    return z;
}

/* An ellipsoid half way between the start of the scan and the surface, over the
 * middle of the labelled rays. */
typedef struct {
    double centre[3], radius[3];
} ellipsoid;

static ellipsoid place_bladder(const wall_case *c) {
    double sum[3] = {0}, front = 0.0, rays = 0.0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->label[i] == HS_LABEL_NEITHER) continue;
        const size_t x = i % c->nx, y = i / c->nx;
        sum[0] += (double)x;
        sum[1] += (double)y;
        sum[2] += clip_of(c, i);
        front += c->first[i];
        rays += 1.0;
    }
    const double thick = (sum[2] - front) / rays;
    return (ellipsoid){{sum[0] / rays, sum[1] / rays, front / rays + 0.4 * thick},
                       {bladder_mm / c->spacing_mm[0], bladder_mm / c->spacing_mm[1], 0.25 * thick}};
}

static bool is_inside(const ellipsoid *e, size_t x, size_t y, uint32_t z) {
    const double at[3] = {(double)x, (double)y, z};
    double sum = 0.0;
    for (int k = 0; k < 3; k++) sum += pow((at[k] - e->centre[k]) / e->radius[k], 2.0);
    return sum < 1.0;
}

/* Whether a voxel becomes fluid. */
static bool becomes_fluid(const wall_case *c, site_variant kind, const ellipsoid *bladder, size_t i,
                          uint32_t clip, uint32_t z) {
    const double between = between_mm / c->spacing_mm[2];
    if (kind == SITE_BLADDER)
        return is_inside(bladder, i % c->nx, i / c->nx, z) &&
               (c->label[i] == HS_LABEL_NEITHER || (double)z + between < (double)clip);
    if (kind == SITE_NO_FETUS) return c->label[i] != HS_LABEL_NEITHER && z >= clip;
    return z < clip;
}

bool site_variant_make(const wall_case *from, site_variant kind, wall_case *out, hs_error *err) {
    static uint8_t pool[POOL];
    uint32_t state = 1;
    *out = (wall_case){0};
    const size_t plane = plane_of(from), levels = find_fluid(from, pool);
    if (levels < LEAST_POOL)
        return hs_fail(err, HS_ERR_INPUT, "%s: %zu voxels of fluid before the surface, expected %d or more",
                       from->name, levels, LEAST_POOL);
    if (!make_like(from, 0, out, err)) return false;
    const ellipsoid bladder = place_bladder(from);
    memcpy(out->full, from->full, plane * from->nz);
    memcpy(out->first, from->first, plane * sizeof *out->first);
    memcpy(out->end, from->end, plane * sizeof *out->end);
    memcpy(out->label, from->label, plane);
    for (size_t i = 0; i < plane; i++) {
        const uint32_t clip = clip_of(from, i);
        for (uint32_t z = from->first[i]; z < from->end[i]; z++)
            if (becomes_fluid(from, kind, &bladder, i, clip, z))
                out->full[z * plane + i] = kind == SITE_BARE_BLACK ? 0 : pool[next(&state) % levels];
        if (kind == SITE_NO_FETUS && out->label[i] != HS_LABEL_NEITHER) out->label[i] = HS_LABEL_SAC;
    }
    nothing_hides(out, false);
    if (kind == SITE_BLADDER) {
        memcpy(out->truth, from->truth, plane * sizeof *out->truth);
        memcpy(out->clean, from->clean, plane * from->nz);
    }
    return true;
}

/* ---- from a volume that nothing hides */

bool site_bare_view_make(const wall_case *from, site_bare_view kind, wall_case *out, hs_error *err) {
    const bool behind = kind == SITE_FLUID || kind == SITE_BLACK_FLUID;
    const uint32_t lead = behind ? LEAD : 0;
    const size_t plane = plane_of(from);
    uint32_t state = 1;
    if (!make_like(from, lead, out, err)) return false;
    memcpy(out->full + lead * plane, from->full, plane * from->nz);
    for (size_t i = 0; i < plane; i++) {
        const bool seen = from->first[i] < from->end[i];
        out->end[i] = (uint16_t)(kind == SITE_NO_RANGES ? out->nz : seen ? from->end[i] + lead : 0);
        out->first[i] = (uint16_t)(kind == SITE_AS_IT_IS ? from->first[i] : 0);
        for (uint32_t z = 0; seen && kind == SITE_FLUID && z < from->first[i] + lead; z++)
            out->full[z * plane + i] = (uint8_t)(1 + next(&state) % NOISE);
    }
    nothing_hides(out, true);
    return true;
}

/* Writes the slices in which anything was scanned: the room before them would pass for fluid, and the
 * occluders grow with the volume. */
static bool write_volume(const wall_case *c, char *path, size_t size, hs_error *err) {
    uint32_t from = c->nz, to = 0;
    for (size_t i = 0; i < plane_of(c); i++) {
        if (c->first[i] >= c->end[i]) continue;
        if (c->first[i] < from) from = c->first[i];
        if (c->end[i] > to) to = c->end[i];
    }
    if (from >= to) return hs_fail(err, HS_ERR_INPUT, "%s: nothing of it was scanned", c->name);
    const int file = hs_path_temporary("occluded", ".mha", path, size, err);
    if (file < 0) return false;
    (void)close(file);
    const hs_metaimage_array array = {.type = HS_ARRAY_U8,
                                      .data = c->full + from * plane_of(c),
                                      .dims = 3,
                                      .size = {c->nx, c->ny, to - from},
                                      .spacing = {c->spacing_mm[0], c->spacing_mm[1], c->spacing_mm[2]}};
    return hs_metaimage_write(path, &array, err);
}

bool site_occluded_make(const wall_case *from, wall_case *out, hs_error *err) {
    char path[1024];
    hs_eval_source source;
    const hs_eval_request request = {.name = "real", .real = path};
    *out = (wall_case){0};
    if (!write_volume(from, path, sizeof path, err)) return false;
    const bool open = hs_eval_source_open(&source, &request, err);
    (void)unlink(path);
    if (!open) return false;
    const bool ok = wall_case_take(&source, out, err);
    hs_eval_source_close(&source);
    if (ok) memcpy(out->name, from->name, sizeof out->name);
    return ok;
}
