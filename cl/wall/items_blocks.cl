/* SPDX-License-Identifier: MIT */
/*
 * By work items: which blocks were scanned, their histogram, and their dilation along x; blocks of one slice,
 * smoothed.
 */
#ifndef SV_WALL_SLICES_CLH
#include "wall/wall_slices.clh"
#endif
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif
#ifndef SV_WALL_BEAMS_CLH
#include "wall/wall_beams.clh"
#endif

/* Finds the layers at which all voxels of a ray were scanned. `ranges`: planes of the pixels' ranges. */
static void find_range(const sv_wall_layout *l, const sv_wall_span *across, const sv_wall_span *along,
                       uint pitch, __global const ushort *ranges, ushort *first, ushort *end) {
    uint from = 0, to = l->slices;
    for (uint y = along->first; y < along->first + along->count; y++)
        for (uint x = across->first; x < across->first + across->count; x++) {
            __global const ushort *at = ranges + (size_t)y * pitch + x;
            from = max(from, (uint)at[0]);
            to = min(to, (uint)at[(size_t)l->height * pitch]);
        }
    from = (from + l->depth - 1) / l->depth;
    to = to == l->slices ? l->layers : to / l->depth;
    *first = (ushort)(from < to ? from : 0);
    *end = (ushort)(from < to ? to : 0);
}

/* One work group per row of cells. Levels of blocks that were not scanned become 0. `bounded`: the pixels
 * have ranges. If wall_items_smooth follows, that kernel counts the levels. */
__kernel void wall_items_blocks(sv_wall_layout l, uint bounded, uint pitch,
                                __global const sv_wall_span *restrict spans,
                                __global const ushort *restrict ranges, __global uchar *restrict levels,
                                __global ushort *restrict rays, __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    clear_counts(counts);
    for (uint i = (uint)get_local_id(0); i < 2 * l.columns; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        const bool counted = !l.smoothed && is_counted(&l, at);
        ushort first = 0, end = (ushort)l.layers;
        if (bounded) {
            const sv_wall_span across = spans[at.x], along = spans[l.columns + at.row];
            find_range(&l, &across, &along, pitch, ranges, &first, &end);
        }
        rays[block_row(&l, RAY_FIRST, at.row) + at.x] = first;
        rays[block_row(&l, RAY_END, at.row) + at.x] = end;
        if (end > first) atomic_inc(counts + HISTOGRAM_RAYS);
        for (uint z = 0; z < l.layers; z++) {
            __global uchar *level = levels + level_row(&l, z, at.row) + at.x;
            const bool scanned = z >= first && z < end;
            if (!scanned) *level = 0;
            if (scanned && counted) atomic_inc(counts + *level);
        }
    }
    store_counts(counts, HISTOGRAM_RAYS, histograms + get_group_id(0) * HISTOGRAM_WORDS);
}

/* Where a sample lies along an axis of `count` blocks: in front of block low + 1 by SV_WALL_PART_ONE - part.
 */
typedef struct {
    uint low, part;
} between_blocks_t;

static between_blocks_t find_blocks(int at, uint count) {
    const uint inside = (uint)clamp(at, 0, (int)((count - 1) << SV_WALL_POSITION_BITS) - 1);
    return (between_blocks_t){inside >> SV_WALL_POSITION_BITS,
                              inside % (1 << SV_WALL_POSITION_BITS) * SV_WALL_PART_ONE >>
                                  SV_WALL_POSITION_BITS};
}

/* Returns the level at sample k of a beam, linear between the eight blocks around it; 0 if the nearest was
 * not scanned. Another one that was not counts as the nearest. `camera`: as wall_items_blocks leaves it. */
static uint level_on_beam(const sv_wall_grid *g, __global const uchar *camera, const beam_t *b, uint k) {
    const int at[3] = {b->from[0] + (int)k * b->step[0], b->from[1] + (int)k * b->step[1],
                       b->from[2] + (int)k * b->step[2]};
    if (k < b->first || !IN_BLOCKS(at[0], g->columns) || !IN_BLOCKS(at[1], g->rows) ||
        !IN_BLOCKS(at[2], g->layers))
        return 0;
    const between_blocks_t x = find_blocks(at[0], g->columns), y = find_blocks(at[1], g->rows);
    const between_blocks_t z = find_blocks(at[2], g->layers);
    const size_t layer = camera_layer_pitch(g), row = camera_row_pitch(g);
    const uint up = SV_WALL_PART_ONE / 2;
    camera += SV_WALL_BESIDE + y.low * row + z.low * layer + x.low;
    const uint nearest = camera[(y.part >= up) * row + (z.part >= up) * layer + (x.part >= up)];
    uint sum = 0;
    for (uint i = 0; i < 8; i++) {
        const uint level = camera[(i >> 1 & 1) * row + (i >> 2) * layer + (i & 1)];
        sum += (i & 1 ? x.part : SV_WALL_PART_ONE - x.part) * (i & 2 ? y.part : SV_WALL_PART_ONE - y.part) *
               (i & 4 ? z.part : SV_WALL_PART_ONE - z.part) * (level ? level : nearest);
    }
    return nearest ? (sum + SV_WALL_PARTS / 2) / SV_WALL_PARTS : 0;
}

/* One work group per row of cells of a grid along the beams: the levels at its samples. A beam was scanned
 * from its first sample that is not black to its last. Everything else as wall_items_blocks. */
__kernel void wall_items_gather(sv_wall_layout l, sv_wall_grid g, __global const uint *restrict tables,
                                __global const uchar *restrict camera, __global uchar *restrict levels,
                                __global ushort *restrict rays, __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    const size_t pitch = level_pitch_of(&l);
    clear_counts(counts);
    for (uint i = (uint)get_local_id(0); i < 2 * l.columns; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        const beam_t beam = beam_of(&g, tables, at.x, at.row);
        __global uchar *to = levels + level_row(&l, 0, at.row) + at.x;
        uint first = 0, end = 0;
        for (uint k = 0; k < l.layers; k++) {
            const uint level = level_on_beam(&g, camera, &beam, k);
            to[k * pitch] = (uchar)level;
            if (level > 0 && end == 0) first = k;
            if (level > 0) end = k + 1;
        }
        rays[block_row(&l, RAY_FIRST, at.row) + at.x] = (ushort)first;
        rays[block_row(&l, RAY_END, at.row) + at.x] = (ushort)end;
        if (end > 0) atomic_inc(counts + HISTOGRAM_RAYS);
        for (uint k = first; is_counted(&l, at) && k < end; k++) atomic_inc(counts + to[k * pitch]);
    }
    store_counts(counts, HISTOGRAM_RAYS, histograms + get_group_id(0) * HISTOGRAM_WORDS);
}

/* Smooths and counts the levels of a ray. A block that was not scanned counts as its neighbour. */
static void smooth_ray(const sv_wall_layout *l, ray_place_t at, __global const uchar *levels,
                       __global const ushort *rays, __global uchar *smoothed, __local uint *counts) {
    const size_t ray = level_row(l, 0, at.row) + at.x, pitch = level_pitch_of(l);
    const uint first = rays[block_row(l, RAY_FIRST, at.row) + at.x];
    const uint end = rays[block_row(l, RAY_END, at.row) + at.x];
    const bool counted = is_counted(l, at);
    for (uint z = 0; z < l->layers; z++) {
        const size_t here = ray + z * pitch;
        uint level = 0;
        if (z >= first && z < end) {
            const uint own = levels[here], before = z > first ? levels[here - pitch] : own;
            const uint behind = z + 1 < end ? levels[here + pitch] : own;
            const uint sum = (SV_WALL_AXIAL_SUM - 2) * own + before + behind;
            level = (sum + SV_WALL_AXIAL_SUM / 2) / SV_WALL_AXIAL_SUM;
            if (counted) atomic_inc(counts + level);
        }
        smoothed[here] = (uchar)level;
    }
}

/* One work group per row of cells, after wall_items_blocks, if layers are one slice. `smoothed` is laid out
 * like `levels`. */
__kernel void wall_items_smooth(sv_wall_layout l, __global const uchar *restrict levels,
                                __global const ushort *restrict rays, __global uchar *restrict smoothed,
                                __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    clear_counts(counts);
    for (uint i = (uint)get_local_id(0); i < 2 * l.columns; i += (uint)get_local_size(0))
        smooth_ray(&l, ray_of_group(&l, i), levels, rays, smoothed, counts);
    store_counts(counts, NO_EXTRA, histograms + get_group_id(0) * HISTOGRAM_WORDS);
}

/* One work item per cell: the dilation along x of the means of a block and the one behind it. Zeros lie
 * behind the last layer. */
__kernel void wall_items_dilate_rows(sv_wall_layout l, __global const uchar *restrict levels,
                                     __global uchar *restrict row_maxima) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0]) return;
    const uint from = x - min(x, l.dilation[0]), to = min(x + l.dilation[0], l.cells[0] - 1);
    uint maximum = 0;
    for (uint r = 2 * row; r < 2 * row + 2; r++) {
        __global const uchar *at = levels + level_row(&l, z, r), *behind = levels + level_row(&l, z + 1, r);
        for (uint k = 2 * from; k < 2 * to + 2; k++) maximum = max(maximum, (at[k] + behind[k] + 1u) / 2u);
    }
    row_maxima[cell_row(&l, z, row) + x] = (uchar)maximum;
}
