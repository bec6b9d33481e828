/* SPDX-License-Identifier: MIT */
/*
 * Ray profiles (spec 3; thesis Algorithm 4.1) for GPUs: one ray per work item, neighbouring rays in
 * neighbouring work items, so that a slice's reads coalesce. The state and its meaning are those of
 * profile_strip.cl.
 */
#ifndef SV_SHARED_H
#include "common/sv_shared.h"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* 1: voxels equal to `padding` were not scanned. */
#ifndef SV_PADDED
#define SV_PADDED 0
#endif

/* 1: every ray has a range of scanned slices, in two planes (profile/scanned.cl). */
#ifndef SV_RANGED
#define SV_RANGED 0
#endif

/* The grey levels that slices are compared with, and the ray's scanned slices. */
typedef struct {
    uint level, level_n, padding;
    uint first, end;
} ray_limits_t;

static bool not_scanned(uint v, uint slice, const ray_limits_t *l) {
    bool none = false;
#if SV_PADDED
    none = v == l->padding;
#endif
#if SV_RANGED
    none = none || slice < l->first || slice >= l->end;
#endif
    return none;
}

/* The state of a ray; positions in samples from the start of the volume. */
typedef struct {
    uint maximum, tissue, last;
    uint entry, exit, max_entry, max_exit;
} ray_t;

/* Samples after the previous slice at which a ray going from voxel a to b changes side of the threshold. */
static uint ray_crossing_step(uint a, uint b, bool b_is_tissue, uint level_n) {
    uint step = 1;
    for (uint j = 1; j < SV_SUBSTEPS; j++) {
        const bool above = a * (SV_SUBSTEPS - j) + b * j > level_n;
        step += above != b_is_tissue;
    }
    return step;
}

static void ray_slice(ray_t *r, uint v, uint slice, const ray_limits_t *l) {
    if (not_scanned(v, slice, l)) {
        r->last = v;
        return;
    }
    const bool tissue = v > l->level;
    const bool follows = slice > 0 && !not_scanned(r->last, slice - 1, l);
    /* Computed for every slice and selected afterwards, as profile_strip.cl does. Computed in a branch, it
     * stops PoCL 6.0: the compiler moves the read of r->last into the branch, needs a second round to settle,
     * allows itself only one, and aborts the process. */
    const uint crossing = ray_crossing_step(r->last, v, tissue, l->level_n);
    const uint step = follows ? crossing : SV_SUBSTEPS;
    const uint position = slice * SV_SUBSTEPS - SV_SUBSTEPS + step;
    if (tissue && !r->tissue) r->entry = position;
    if (!tissue && r->tissue) r->exit = position;
    if (v > r->maximum) {
        r->maximum = v;
        r->max_entry = r->entry;
        r->max_exit = r->exit;
    }
    r->tissue = tissue;
    r->last = v;
}

__kernel void profile_rays(__global const uchar *restrict slabs, sv_batch batch, uint row_pitch, uint tiles_x,
                           uint tile_w, uint tile_h, uint width, uint padded_width, uint height, uint level,
                           uint level_n, uint padding, __global const ushort *restrict scanned,
                           __global uchar *restrict state8, __global ushort *restrict state16) {
    const uint x = (uint)get_global_id(0);
    const uint y = (uint)get_global_id(1);
    if (x >= width) return;
    const size_t plane_size = (size_t)padded_width * height;
    __global uchar *s8 = state8 + (size_t)y * padded_width + x;
    __global ushort *s16 = state16 + (size_t)y * padded_width + x;
    ray_limits_t limits = {level, level_n, padding, 0, 0};
#if SV_RANGED
    limits.first = scanned[SV_SCANNED_FIRST * plane_size + (size_t)y * padded_width + x];
    limits.end = scanned[SV_SCANNED_END * plane_size + (size_t)y * padded_width + x];
#endif
    ray_t r = {0, 1, 0, 0, 0, 0, 0};
    uint slice = batch.first_slice;
    if (slice > 0) {
        r.maximum = s8[SV_STATE_MAX * plane_size];
        r.tissue = s8[SV_STATE_TISSUE * plane_size] != 0;
        r.last = s8[SV_STATE_LAST * plane_size];
        r.entry = s16[SV_STATE_ENTRY * plane_size];
        r.exit = s16[SV_STATE_EXIT * plane_size];
        r.max_entry = s16[SV_STATE_MAX_ENTRY * plane_size];
        r.max_exit = s16[SV_STATE_MAX_EXIT * plane_size];
    }
    for (uint n = 0; n < batch.count; n++)
        for (uint i = 0; i < batch.slices[n]; i++, slice++) {
            const size_t row = (size_t)(i / tiles_x) * tile_h + y;
            const uint v = slabs[batch.offset[n] + row * row_pitch + (size_t)(i % tiles_x) * tile_w + x];
            ray_slice(&r, v, slice, &limits);
        }
    s8[SV_STATE_MAX * plane_size] = (uchar)r.maximum;
    s8[SV_STATE_TISSUE * plane_size] = r.tissue ? (uchar)255 : (uchar)0;
    s8[SV_STATE_LAST * plane_size] = (uchar)r.last;
    s16[SV_STATE_ENTRY * plane_size] = (ushort)r.entry;
    s16[SV_STATE_EXIT * plane_size] = (ushort)r.exit;
    s16[SV_STATE_MAX_ENTRY * plane_size] = (ushort)r.max_entry;
    s16[SV_STATE_MAX_EXIT * plane_size] = (ushort)r.max_exit;
}
