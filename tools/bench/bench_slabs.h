/* SPDX-License-Identifier: MIT */
/* The benchmark's volume, cut into slabs as a host would deliver them. */
#ifndef BENCH_SLABS_H
#define BENCH_SLABS_H

#include "bench/plain_volume.h"
#include "render/scan_convert.h"

/* Intensities of the volume, grey levels: fluid 1 .. 40, tissue 60 .. 150, bone 220 .. 255. */
enum { BENCH_FLUID_LEVEL = 40 };

/*
 * Voxel (x, y, z) of the volume with n x n rays of `slices` voxels, the same at every call: a wall, fluid,
 * then tissue with bones that 3 % of the rays meet; a few rays meet bone in the wall, before any fluid. All
 * layers have noise.
 *
 * slice[z] is the first of n rows, `pitch` bytes apart, of n bytes. HS_ERR_MEMORY.
 */
bool bench_volume_fill(uint32_t n, uint32_t slices, uint8_t *const *slice, size_t pitch, hs_error *err);

typedef struct {
    hs_slab_layout layout;
    uint32_t count;      /* slabs */
    size_t stride;       /* bytes from one slab's texture to the next */
    size_t bytes;        /* of all */
    uint8_t *memory;     /* owned */
    uint8_t **slice;     /* owned: where each slice begins */
    plain_volume volume; /* the same voxels */
} bench_slabs;

/* n voxels an axis in slabs of slab_slices, tiles as square as the host's scan
 * loop lays them. HS_ERR_MEMORY. */
bool bench_slabs_create(bench_slabs *slabs, uint32_t n, uint32_t slab_slices, hs_error *err);
void bench_slabs_destroy(bench_slabs *slabs);

#endif
