/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, blocks: which of them were scanned, their histogram, and the brightest of a row beside
 * every ray.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_HISTOGRAM_CLH
#include "wall/wall_histogram.clh"
#endif
#ifndef SV_WALL_SLICES_CLH
#include "wall/wall_slices.clh"
#endif

/* The ranges of a row of rays, and how many of them were scanned. */
static uint find_ranges(const sv_wall_layout *l, uint row, uint bounded, uint pitch,
                        __global const sv_wall_span *spans, __global const ushort *ranges,
                        __global ushort *rays) {
    __global ushort *first = (__global ushort *)ray_row(rays, l, RAY_FIRST, row);
    __global ushort *end = (__global ushort *)ray_row(rays, l, RAY_END, row);
    const sv_wall_span along = spans[l->columns + row];
    uint count = 0;
    for (uint x = 0; x < l->columns; x++) {
        ushort from = 0, to = (ushort)l->layers;
        if (bounded) {
            const sv_wall_span across = spans[x];
            find_range(l, &across, &along, pitch, ranges, &from, &to);
        }
        first[x] = from;
        end[x] = to;
        count += to > from;
    }
    return count;
}

/* Means of LANES levels and of those behind them, rounded half up. */
static u8l mean_at(__global const uchar *at, __global const uchar *behind) {
    const u8l a = ((__global const u8l_anywhere *)at)->v, b = ((__global const u8l_anywhere *)behind)->v;
    return TO_U8((TO_U16(a) + TO_U16(b) + (ushort)1) >> (ushort)1);
}

/* The largest of these means in row `row` of layer `z` and of those up to `reach` to either side. */
static void largest_of_row(const sv_wall_layout *l, __global const uchar *levels, uint z, uint row,
                           __global uchar *to) {
    __global const uchar *at = levels + level_row(l, z, row), *behind = levels + level_row(l, z + 1, row);
    const int reach = (int)l->beside[0];
    to += block_row(l, z, row);
    for (int x = 0; x < (int)padded_columns_of(l); x += LANES) {
        u8l most = mean_at(at + x, behind + x);
        for (int k = -reach; k <= reach; k++) {
            const u8l other = mean_at(at + x + k, behind + x + k);
            most = MOST(most, other);
        }
        *(__global u8l *)(to + x) = most;
    }
}

/* One work item per row of rays. Levels of blocks that were not scanned become 0. `bounded`: the pixels have
 * ranges. `beside`: the largest means of a row beside every ray. Where wall_steady follows, that counts the
 * levels. */
__kernel void wall_blocks(sv_wall_layout l, uint bounded, uint pitch,
                          __global const sv_wall_span *restrict spans, __global const ushort *restrict ranges,
                          __global uchar *restrict levels, __global ushort *restrict rays,
                          __global uchar *restrict beside, __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0), vectors = vectors_of(&l);
    const bool steadied = is_steadied(&l);
    __global const i16l *first = (__global const i16l *)ray_row(rays, &l, RAY_FIRST, row);
    __global const i16l *end = (__global const i16l *)ray_row(rays, &l, RAY_END, row);
    uint histogram[4][256];
    clear_counts(histogram);
    histograms += (size_t)row * HISTOGRAM_WORDS;
    histograms[HISTOGRAM_RAYS] = find_ranges(&l, row, bounded, pitch, spans, ranges, rays);
    for (uint z = 0; z < l.layers; z++) {
        const i16l at = (i16l)((short)z);
        __global u8l *here = (__global u8l *)(levels + level_row(&l, z, row));
        for (uint x = 0; x < vectors; x++) {
            const i16l scanned = (first[x] <= at) & (end[x] > at);
            const u8l level = here[x] & bytes_of(scanned);
            here[x] = level;
            if (!steadied) count(histogram, level, scanned);
        }
        /* a layer later: a vector that was just stored is slow to load in parts */
        if (z > 1) largest_of_row(&l, levels, z - 2, row, beside);
    }
    if (l.layers > 1) largest_of_row(&l, levels, l.layers - 2, row, beside);
    largest_of_row(&l, levels, l.layers - 1, row, beside); /* zeros lie behind the last layer */
    if (!steadied) leave_counts(histogram, histograms);
}
