/* SPDX-License-Identifier: MIT */
#include "support/rig.h"

#include "ref/ref_mean.h"

#include <assert.h>

rig_settings rig_default_settings(void) {
    return (rig_settings){.fluid_threshold = 40.5 / 255.0,
                          .omega = 0.5,
                          .bone = {.fluid_threshold = 40.5 / 255.0,
                                   .bone_mode = SV_REF_OFFSET,
                                   .bone_threshold = 0.74,
                                   .bone_offset = 0.24,
                                   .bone_fraction = 0.03},
                          .k = 23,
                          .substeps = 1,
                          .q = 0.5f,
                          .evidence = 0.0,
                          .min_gap = 2.0};
}

/* float64: near and far surfaces, then S(q), all by the definition. */
static void expect_double(rig_expected *e, const rig_settings *s, const double *near_end,
                          const double *far_end, uint32_t width, uint32_t height) {
    const size_t count = (size_t)width * height;
    double *near_surface = unit_memory(count * sizeof(double));
    double *far_surface = unit_memory(count * sizeof(double));
    sv_ref_fill fill;
    const bool ok = sv_ref_mean(e->status, near_end, width, height, s->k, s->omega, near_surface, &fill) &&
                    sv_ref_mean(e->status, far_end, width, height, s->k, s->omega, far_surface, &fill);
    assert(ok && fill.passes == e->fill.passes && fill.unfilled == e->fill.unfilled);
    (void)ok;
    e->depth_double = unit_memory(count * sizeof(double));
    for (size_t i = 0; i < count; i++)
        e->depth_double[i] = far_surface[i] + (double)s->q * (near_surface[i] - far_surface[i]);
}

rig_expected rig_expect(const sv_ref_volume *volume, const rig_settings *s, bool with_double) {
    const uint32_t width = volume->width, height = volume->height;
    const size_t count = (size_t)width * height;
    rig_expected e = {.status = unit_memory(count), .depth = unit_memory(count * sizeof(float))};
    sv_ref_ray *rays = unit_memory(count * sizeof *rays);
    double *ends = unit_memory(2 * count * sizeof *ends);
    uint32_t *positions = unit_memory(2 * count * sizeof *positions);
    float *surfaces = unit_memory(2 * count * sizeof *surfaces);
    sv_ref_bone bone = s->bone;
    bone.fluid_threshold = s->fluid_threshold;

    sv_ref_profile(volume, s->fluid_threshold, s->substeps, rays);
    e.level = sv_ref_bone_level(rays, count, &bone);
    e.points = sv_ref_points(rays, count, &bone, e.level, e.status, ends, ends + count);
    for (size_t i = 0; i < 2 * count; i++) positions[i] = (uint32_t)(ends[i] * s->substeps + 0.5);
    for (size_t i = 0; i < count; i++) {
        if (rays[i].maximum > e.maximum) e.maximum = rays[i].maximum;
        e.empty_points += e.status[i] == SV_POINT_EMPTY;
    }
    uint32_t weight_initial, weight_filled;
    sv_fill_weights(s->omega, &weight_initial, &weight_filled);
    e.format = sv_fixed_format(width, height, volume->slices, s->k, weight_initial);
    const bool ok = sv_ref_mean_fixed(e.status, positions, positions + count, width, height, s->k, s->omega,
                                      s->substeps, e.format, surfaces, surfaces + count, &e.fill);
    assert(ok);
    (void)ok;
    const sv_ref_evidence found = sv_ref_gather_evidence(rays, count, e.level, s->min_gap, s->substeps);
    e.sure_points = found.with_gap;
    e.outcome = e.fill.unfilled > 0 ? SV_PARTIAL : SV_OK;
    if (!sv_ref_surface_wanted(e.points, found, s->evidence)) {
        e.outcome = SV_NO_SURFACE;
        e.fill = (sv_ref_fill){0, (uint32_t)count};
        memset(surfaces, 0, 2 * count * sizeof *surfaces);
    }
    sv_ref_blend(surfaces, surfaces + count, count, s->q, e.depth);
    if (with_double && e.outcome == SV_NO_SURFACE) e.depth_double = unit_memory(count * sizeof(double));
    if (with_double && e.outcome != SV_NO_SURFACE) expect_double(&e, s, ends, ends + count, width, height);
    return e;
}

static uint8_t voxel(rig_kind kind, uint32_t x, uint32_t y, uint32_t z, uint32_t slices, uint32_t random) {
    static const uint8_t extremes[] = {0, 1, 39, 40, 41, 42, 254, 255};
    const uint32_t noise = random >> 24;
    switch (kind) {
    case RIG_NOISE:
        return (uint8_t)noise;
    case RIG_EXTREMES:
        return extremes[noise % 8];
    case RIG_LAYERS: {
        const uint32_t wall = slices / 5 + (x + y) / 9 % 4, skin = slices / 2 + (x * y) / 50 % 5;
        if (z < wall) return (uint8_t)(60 + noise % 90);
        if (z < skin) return (uint8_t)(5 + noise % 30);
        if (z == skin + 3 && (x / 4 + y / 4) % 5 == 0) return (uint8_t)(235 + noise % 20);
        return (uint8_t)(50 + noise % 120);
    }
    default:
        if (z == slices - 2 && x % 40 == 7 && y % 50 == 9) return 255;
        return z < slices / 4 ? 90 : (uint8_t)(noise % 40);
    }
}

uint8_t *rig_volume(rig_kind kind, uint32_t width, uint32_t height, uint32_t slices, uint32_t seed) {
    uint8_t *v = unit_memory((size_t)width * height * slices);
    uint32_t state = seed * 2654435761u + 12345u + (uint32_t)kind;
    if (state == 0) state = 1;
    for (uint32_t z = 0; z < slices; z++)
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++)
                v[((size_t)z * height + y) * width + x] = voxel(kind, x, y, z, slices, unit_random(&state));
    return v;
}

uint8_t *rig_map_volume(const int32_t *near_end, const int32_t *far_end, uint32_t width, uint32_t height,
                        uint32_t slices) {
    enum { TISSUE = 90, FLUID = 10, BONE = 255 };
    const size_t count = (size_t)width * height;
    uint8_t *v = unit_memory(count * slices);
    for (size_t i = 0; i < count; i++)
        for (int32_t z = 0; z < (int32_t)slices; z++) {
            const bool fluid = far_end[i] < 0 || (z >= near_end[i] && z < far_end[i]);
            v[(size_t)z * count + i] = z == far_end[i] ? BONE : fluid ? FLUID : TISSUE;
        }
    return v;
}
