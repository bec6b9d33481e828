/* SPDX-License-Identifier: MIT */
/* The benchmark's volume, cut into slabs as a host would deliver them. */
#include "bench/bench.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A volume as slices in tiles: voxel (x, y, z) is slice[z][y * pitch + x]. Not owned. After every row
 * PLAIN_READ_AHEAD bytes more may be read; they do not matter. */
enum { PLAIN_READ_AHEAD = 63 };

enum { ALIGN = 4096 };
_Static_assert(ALIGN >= (int)PLAIN_READ_AHEAD, "the spare bytes after the last slab");

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

static bool volume_fill(uint32_t n, uint32_t slices, uint8_t *const *slice, size_t pitch, hs_error *err) {
    layers *row = malloc(n * sizeof *row);
    if (!row) return hs_fail(err, HS_ERR_MEMORY, "benchmark volume: no memory for %u rays", n);
    for (uint32_t y = 0; y < n; y++) {
        for (uint32_t x = 0; x < n; x++) row[x] = ray_layers(n, slices, x, y);
        for (uint32_t z = 0; z < slices; z++)
            for (uint32_t x = 0; x < n; x++) slice[z][y * pitch + x] = voxel(&row[x], z, hash(x, y, z));
    }
    free(row);
    return true;
}

bool bench_slabs_create(bench_slabs *slabs, uint32_t n, uint32_t slab_slices, hs_error *err) {
    const uint32_t length = slab_slices < n ? slab_slices : n;
    const uint32_t tiles_x = (uint32_t)ceil(sqrt(length));
    *slabs = (bench_slabs){.layout = {.width = n,
                                      .height = n,
                                      .slices = n,
                                      .slab_slices = length,
                                      .tiles_x = tiles_x,
                                      .tile_w = n,
                                      .tile_h = n,
                                      .row_pitch = tiles_x * n}};
    slabs->count = hs_slab_count(&slabs->layout);
    slabs->stride = (hs_slab_bytes(&slabs->layout, length) + ALIGN - 1) / ALIGN * ALIGN;
    slabs->bytes = slabs->stride * slabs->count;
    slabs->memory = aligned_alloc(ALIGN, slabs->bytes + ALIGN); /* plain C reads ahead */
    slabs->slice = malloc(n * sizeof *slabs->slice);
    if (!slabs->memory || !slabs->slice) {
        bench_slabs_destroy(slabs);
        return hs_fail(err, HS_ERR_MEMORY, "benchmark volume: no memory for %u^3 voxels", n);
    }
    memset(slabs->memory, 0, slabs->bytes + ALIGN);
    for (uint32_t z = 0; z < n; z++) {
        const uint32_t in_slab = z % length;
        slabs->slice[z] = slabs->memory + z / length * slabs->stride +
                          (size_t)(in_slab / tiles_x) * n * slabs->layout.row_pitch + in_slab % tiles_x * n;
    }
    slabs->volume = (plain_volume){n, n, n, (const uint8_t *const *)slabs->slice, slabs->layout.row_pitch};
    if (volume_fill(n, n, slabs->slice, slabs->layout.row_pitch, err)) return true;
    bench_slabs_destroy(slabs);
    return false;
}

void bench_slabs_destroy(bench_slabs *slabs) {
    free(slabs->memory);
    free(slabs->slice);
    *slabs = (bench_slabs){0};
}
