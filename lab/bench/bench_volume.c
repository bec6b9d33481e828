/* SPDX-License-Identifier: MIT */
/* The benchmark's volume. */
#include "bench/bench.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* A disc of bone as the viewer sees it; lengths in volume edges. */
typedef struct {
    double x, y, radius, depth, thickness;
} bone;

static const bone bones[] = {
    {0.42, 0.38, 0.034, 0.58, 0.03}, {0.50, 0.35, 0.034, 0.56, 0.03}, {0.58, 0.39, 0.034, 0.58, 0.03},
    {0.45, 0.50, 0.034, 0.62, 0.02}, {0.52, 0.55, 0.034, 0.63, 0.02}, {0.60, 0.60, 0.034, 0.66, 0.02},
    {0.38, 0.62, 0.034, 0.70, 0.02}, {0.66, 0.48, 0.034, 0.72, 0.02}, {0.30, 0.30, 0.015, 0.04, 0.02},
};

/* Where the layers of one ray begin, in slices. */
typedef struct {
    uint32_t fluid, skin, bone, bone_end;
} layers;

static layers ray_layers(uint32_t n, uint32_t slices, uint32_t x, uint32_t y) {
    const double u = (x + 0.5) / n, v = (y + 0.5) / n;
    const double wall = 0.16 + 0.03 * sin(9.0 * u) + 0.02 * cos(7.0 * v);
    const double skin = 0.42 + 0.5 * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5));
    layers l = {(uint32_t)(wall * slices), (uint32_t)(skin * slices), slices, slices};
    for (size_t i = 0; i < sizeof bones / sizeof *bones; i++) {
        const double dx = u - bones[i].x, dy = v - bones[i].y;
        if (dx * dx + dy * dy > bones[i].radius * bones[i].radius) continue;
        l.bone = (uint32_t)(bones[i].depth * slices);
        l.bone_end = (uint32_t)((bones[i].depth + bones[i].thickness) * slices);
    }
    return l;
}

/* 32 well mixed bits of a voxel's place: the noise. */
static uint32_t hash(uint32_t x, uint32_t y, uint32_t z) {
    uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ z * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

static uint8_t voxel(const layers *l, uint32_t z, uint32_t noise) {
    if (z >= l->bone && z < l->bone_end) return (uint8_t)(220u + noise % 36u);
    if (z >= l->fluid && z < l->skin) return (uint8_t)(1u + noise % (uint32_t)BENCH_FLUID_LEVEL);
    return (uint8_t)(60u + noise % 91u);
}

uint8_t *bench_volume_make(uint32_t n, hs_error *err) {
    layers *rays = malloc((size_t)n * n * sizeof *rays);
    uint8_t *voxels = malloc((size_t)n * n * n), *next = voxels;
    if (!rays || !voxels) {
        free(rays);
        free(voxels);
        (void)hs_fail(err, HS_ERR_MEMORY, "benchmark volume: no memory for %u^3 voxels", n);
        return NULL;
    }
    for (uint32_t i = 0; i < n * n; i++) rays[i] = ray_layers(n, n, i % n, i / n);
    for (uint32_t z = 0; z < n; z++)
        for (uint32_t i = 0; i < n * n; i++) *next++ = voxel(&rays[i], z, hash(i % n, i / n, z));
    free(rays);
    return voxels;
}
