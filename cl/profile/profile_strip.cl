/* SPDX-License-Identifier: MIT */
/*
 * Ray profiles (spec 3; thesis Algorithm 4.1) for CPU devices: slabs are merged into the state every ray
 * carries.
 *
 * Access: a work item owns one row y of rays. It walks the row in vectors of SV_STRIP rays and, for each
 * vector, the slab's slices from front to back; all state of the vector is in registers meanwhile:
 *
 *      texture row y:  | slice 0: [v0][v1][v2].. | slice 1: [v0][v1].. | ...
 *                                  ^                         ^  vector v0 reads these, then v1 its own
 *
 * Positions within a chunk of slices are 8-bit and relative to it (0: "not since the chunk began"); they are
 * merged into the 16-bit state once per chunk. So the inner loop has only 8-bit lanes and no branch.
 *
 * Initially a ray counts as being in tissue: then the first scanned voxel, if it is fluid, opens an interval
 * there, and if it is tissue, opens none ("the maximum lies in the first tissue: an empty interval"). Voxels
 * that were not scanned are skipped: they change nothing.
 */
#ifndef SV_SHARED_H
#include "common/sv_shared.h"
#endif
#ifndef SV_LANES_CLH
#include "common/lanes.clh"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* 1: voxels equal to `padding` were not scanned. Structure: without it, two operations a voxel fall away. */
#ifndef SV_PADDED
#define SV_PADDED 0
#endif

/* 1: every ray has a range of scanned slices, in two planes (profile/scanned.cl). Structure, as SV_PADDED. */
#ifndef SV_RANGED
#define SV_RANGED 0
#endif

/* Slices whose relative positions fit eight bits. */
#define STRIP_CHUNK (254 / SV_SUBSTEPS)

/* The state of one vector of rays within a chunk. Masks are 255 or 0. */
typedef struct {
    u8v maximum;
    u8v tissue;
    u8v last;
    u8v entry, exit, max_entry, max_exit; /* relative position; 0: not in this chunk */
#if SV_RANGED
    u8v opens; /* relative position of the ray's first scanned slice; 0: it lies before this chunk */
    u8v ends;  /* relative position of its last one; 0: it lies before this chunk */
#endif
} strip_t;

/* Grey levels as the slices are compared with them; `level_n` is T_L in units of 1 / SV_SUBSTEPS level. */
typedef struct {
    uchar level;
    ushort level_n;
    uchar padding;
} strip_levels_t;

#if SV_SUBSTEPS > 1
/*
 * Sample number (1 .. SV_SUBSTEPS) after the previous slice at which a ray that goes from voxel a to voxel b
 * changes side of the threshold. The samples between are linear, (a (n - j) + b j) / n, kept as integers
 * times n.
 */
static u8v crossing_step(u8v a, u8v b, u8v b_is_tissue, ushort level_n) {
    u8v step = U8V(1);
    const u16v tissue = AS_U16V(WIDEN_I(AS_I8V(b_is_tissue)));
    for (ushort j = 1; j < SV_SUBSTEPS; j++) {
        const u16v value = WIDEN_U(a) * U16V(SV_SUBSTEPS - j) + WIDEN_U(b) * U16V(j);
        const u16v above = AS_U16V(value > U16V(level_n));
        step += NARROW_U((above ^ tissue) & U16V(1)); /* still on a's side */
    }
    return step;
}
#endif

/* One slice of voxels v; `slice` counts from the chunk's first. `alone`: no slice came before. */
static void strip_slice(strip_t *s, u8v v, uint slice, bool alone, strip_levels_t levels) {
    u8v tissue = AS_U8V(v > U8V(levels.level));
    u8v value = v;
#if SV_PADDED || SV_RANGED
    u8v unscanned = U8V(0);
#if SV_PADDED
    unscanned = AS_U8V(v == U8V(levels.padding));
#endif
#if SV_RANGED
    unscanned |= AS_U8V(U8V(slice + 1) < s->opens) | AS_U8V(U8V(slice + 1) > s->ends);
#endif
    tissue = (tissue & ~unscanned) | (s->tissue & unscanned);
    value = v & ~unscanned;
#endif
#if SV_SUBSTEPS > 1
    u8v step = crossing_step(s->last, v, tissue, levels.level_n);
#if SV_PADDED
    step = s->last == U8V(levels.padding) ? U8V(SV_SUBSTEPS) : step;
#endif
#if SV_RANGED
    step = s->opens == U8V(slice + 1) ? U8V(SV_SUBSTEPS) : step;
#endif
    const u8v position = (alone ? U8V(SV_SUBSTEPS) : step) + U8V(slice * SV_SUBSTEPS);
    s->last = v;
#else
    const u8v position = U8V(slice + 1);
#endif
    const u8v rise = tissue & ~s->tissue;
    const u8v fall = s->tissue & ~tissue;
    s->entry = AS_I8V(rise) ? position : s->entry;
    s->exit = AS_I8V(fall) ? position : s->exit;
    const i8v larger = value > s->maximum;
    s->maximum = larger ? value : s->maximum;
    s->max_entry = larger ? s->entry : s->max_entry;
    s->max_exit = larger ? s->exit : s->max_exit;
    s->tissue = tissue;
}

/* How the slices of a slab lie in its texture. */
typedef struct {
    uint row_pitch, tiles_x, tile_w, tile_h;
} strip_texture_t;

/* Voxels x .. x + SV_STRIP - 1 of a row that is shorter than a vector, without a read beyond it. */
static u8v load_clipped(__global const uchar *row, uint width) {
    uchar lanes[SV_STRIP];
    for (uint i = 0; i < SV_STRIP; i++) lanes[i] = i < width ? row[i] : (uchar)0;
    return U8V_FROM(lanes);
}

/* 255 in the lanes below `count`, 0 in the rest. */
static u8v first_lanes(uint count) {
    uchar lanes[SV_STRIP];
    for (uint i = 0; i < SV_STRIP; i++) lanes[i] = i < count ? (uchar)255 : (uchar)0;
    return U8V_FROM(lanes);
}

/*
 * Slices done .. done + count - 1 of a slab for the vector at x. `clip` (a constant at each call): the whole
 * row is shorter than the vector.
 */
static inline void strip_chunk(strip_t *s, __global const uchar *texture, strip_texture_t t, uint x,
                               uint width, uint done, uint count, bool alone, strip_levels_t levels,
                               bool clip) {
    uint tile_x = done % t.tiles_x;
    __global const uchar *row =
        texture + (size_t)(done / t.tiles_x) * t.tile_h * t.row_pitch + tile_x * t.tile_w;
    for (uint i = 0; i < count; i++) {
        const u8v v = clip ? load_clipped(row, width) : U8V_LOAD(row + x);
        SV_PREFETCH(row + x + t.row_pitch);
        strip_slice(s, v, i, alone && i == 0, levels);
        row += t.tile_w;
        if (++tile_x == t.tiles_x) {
            tile_x = 0;
            row += (size_t)t.tile_h * t.row_pitch - (size_t)t.tiles_x * t.tile_w;
        }
    }
}

/* Relative positions to 16-bit ones; `old` where nothing happened in this chunk. */
static u16v absolute_position(u8v relative, u16v old, int base) {
    const u16v wide = WIDEN_U(relative);
    return wide == U16V(0) ? old : wide + U16V(base);
}

#define STATE_AT(state, plane) ((state) + (plane)*plane_size + offset)
#define STATE_OLD(plane)       (first ? U16V(0) : U16V_LOAD(STATE_AT(state16, plane)))

/* Stores `value`, but leaves the lanes of `keep` as they are stored. */
static void store8(u8v value, __global uchar *at, u8v keep, bool overlaps) {
    if (overlaps) value = (value & ~keep) | (U8V_LOAD(at) & keep);
    U8V_STORE(value, at);
}
static void store16(u16v value, __global ushort *at, u8v keep, bool overlaps) {
    if (overlaps) value = WIDEN_I(AS_I8V(keep)) ? U16V_LOAD(at) : value;
    U16V_STORE(value, at);
}

/*
 * Merges a chunk into the stored state. `base` + relative position = position from the start of the volume.
 * The last vector of a row is moved back so that it ends with the row; the lanes in which it `overlaps` the
 * one before (keep) have been merged already.
 */
static void strip_merge(const strip_t *s, u8v old_maximum, __global uchar *state8, __global ushort *state16,
                        size_t plane_size, size_t offset, int base, bool first, u8v keep, bool overlaps) {
    const u16v entry = STATE_OLD(SV_STATE_ENTRY);
    const u16v exit = STATE_OLD(SV_STATE_EXIT);
    const u16v max_entry = STATE_OLD(SV_STATE_MAX_ENTRY);
    const u16v max_exit = STATE_OLD(SV_STATE_MAX_EXIT);
    const i16v larger = WIDEN_I(s->maximum > old_maximum);
    const u16v new_max_entry = larger ? absolute_position(s->max_entry, entry, base) : max_entry;
    const u16v new_max_exit = larger ? absolute_position(s->max_exit, exit, base) : max_exit;
    store16(absolute_position(s->entry, entry, base), STATE_AT(state16, SV_STATE_ENTRY), keep, overlaps);
    store16(absolute_position(s->exit, exit, base), STATE_AT(state16, SV_STATE_EXIT), keep, overlaps);
    store16(new_max_entry, STATE_AT(state16, SV_STATE_MAX_ENTRY), keep, overlaps);
    store16(new_max_exit, STATE_AT(state16, SV_STATE_MAX_EXIT), keep, overlaps);
    store8(s->maximum, STATE_AT(state8, SV_STATE_MAX), keep, overlaps);
    store8(s->tissue, STATE_AT(state8, SV_STATE_TISSUE), keep, overlaps);
#if SV_SUBSTEPS > 1
    store8(s->last, STATE_AT(state8, SV_STATE_LAST), keep, overlaps);
#endif
}

/* The map and the state as a work item sees them. */
typedef struct {
    uint y, width, padded_width, height;
    __global const ushort *scanned;
    __global uchar *state8;
    __global ushort *state16;
} strip_row_t;

#if SV_RANGED
/* Slices to positions relative to a chunk that begins at slice `before`, of which 0 lies before the chunk and
 * 255 behind any: `first` is its own slice's position, `end` that of the slice before it. */
static void strip_range(strip_t *s, u16v first, u16v end, uint before) {
    const u16v base = U16V(before);
    const u16v opens = first < base ? U16V(0) : first - base + U16V(1);
    const u16v ends = end < base ? U16V(0) : end - base;
    s->opens = NARROW_U(opens > U16V(255) ? U16V(255) : opens);
    s->ends = NARROW_U(ends > U16V(255) ? U16V(255) : ends);
}
#endif

/* Slices done .. done + count - 1 of a slab (no more than fit a chunk) for every vector of a row. `texture`
 * is the slab's texture at this row, `before` the slices of the volume that came before slice `done`. */
static void strip_row(const strip_row_t *r, __global const uchar *texture, strip_texture_t t, uint done,
                      uint count, uint before, strip_levels_t levels) {
    __global uchar *state8 = r->state8;
    __global ushort *state16 = r->state16;
    const size_t plane_size = (size_t)r->padded_width * r->height;
    const bool clip = r->width < SV_STRIP;
    const bool first = before == 0;
    const int base = ((int)before - 1) * SV_SUBSTEPS;
    for (uint column = 0; column < r->width; column += SV_STRIP) {
        const bool overlaps = column + SV_STRIP > r->width && !clip;
        const uint x = overlaps ? r->width - SV_STRIP : column;
        const u8v keep = overlaps ? first_lanes(column - x) : U8V(0);
        const size_t offset = (size_t)r->y * r->padded_width + x;
        strip_t s;
        s.maximum = first ? U8V(0) : U8V_LOAD(STATE_AT(state8, SV_STATE_MAX));
        s.tissue = first ? U8V(255) : U8V_LOAD(STATE_AT(state8, SV_STATE_TISSUE));
        s.last = U8V(0);
#if SV_SUBSTEPS > 1
        if (!first) s.last = U8V_LOAD(STATE_AT(state8, SV_STATE_LAST));
#endif
        s.entry = s.exit = s.max_entry = s.max_exit = U8V(0);
#if SV_RANGED
        strip_range(&s, U16V_LOAD(r->scanned + SV_SCANNED_FIRST * plane_size + offset),
                    U16V_LOAD(r->scanned + SV_SCANNED_END * plane_size + offset), before);
#endif
        const u8v old_maximum = s.maximum;
        if (clip)
            strip_chunk(&s, texture, t, x, r->width, done, count, first, levels, true);
        else
            strip_chunk(&s, texture, t, x, r->width, done, count, first, levels, false);
        strip_merge(&s, old_maximum, state8, state16, plane_size, offset, base, first, keep, overlaps);
    }
}

__kernel void profile_strip(__global const uchar *restrict slabs, sv_batch batch, uint row_pitch,
                            uint tiles_x, uint tile_w, uint tile_h, uint width, uint padded_width,
                            uint height, uint level, uint level_n, uint padding,
                            __global const ushort *restrict scanned, __global uchar *restrict state8,
                            __global ushort *restrict state16) {
    const strip_row_t row = {(uint)get_global_id(0), width, padded_width, height, scanned, state8, state16};
    const strip_texture_t t = {row_pitch, tiles_x, tile_w, tile_h};
    const strip_levels_t levels = {(uchar)level, (ushort)level_n, (uchar)min(padding, 255u)};
    uint before = batch.first_slice;
    for (uint n = 0; n < batch.count; n++) {
        __global const uchar *texture = slabs + batch.offset[n] + (size_t)row.y * row_pitch;
        for (uint done = 0; done < batch.slices[n]; done += STRIP_CHUNK) {
            const uint count = min((uint)STRIP_CHUNK, batch.slices[n] - done);
            strip_row(&row, texture, t, done, count, before, levels);
            before += count;
        }
    }
}
