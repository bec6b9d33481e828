/* SPDX-License-Identifier: MIT */
/*
 * Blocks: which of them were scanned, their histogram, and their dilation along x.
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

/* Finds the ranges of a row of rays. Returns how many of them were scanned. */
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

/* Averages LANES levels with those behind them, rounding half up. */
static u8l mean_at(__global const uchar *at, __global const uchar *behind) {
    const u16l sum = TO_U16(*(__global const u8l *)at) + TO_U16(*(__global const u8l *)behind);
    return TO_U8((sum + (ushort)1) >> (ushort)1);
}

/* Finds the maximum of these means in every cell of row `row` of layer `z`. */
static void maximum_of_cells(const sv_wall_layout *l, __global const uchar *levels, uint z, uint row,
                             __global uchar *line) {
    for (uint x = 0; x < padded_columns_of(l); x += LANES) {
        const u8l above =
            mean_at(levels + level_row(l, z, 2 * row) + x, levels + level_row(l, z + 1, 2 * row) + x);
        const u8l below =
            mean_at(levels + level_row(l, z, 2 * row + 1) + x, levels + level_row(l, z + 1, 2 * row + 1) + x);
        const u16h pairs = REINTERPRET(MAXIMUM(above, below), u16h); /* neighbours share a word */
        const u16h left = pairs & (ushort)255, right = pairs >> (ushort)8;
        *(__global u8h *)(line + x / 2) = HALF_TO_U8(MAXIMUM(left, right));
    }
}

/* Grey dilation along x of a line of cells. */
static void dilate_line(const sv_wall_layout *l, __global const uchar *line, __global uchar *to) {
    const int reach = (int)l->dilation[0];
    for (int x = 0; x < (int)padded_cells_of(l); x += LANES) {
        u8l maximum = *(__global const u8l *)(line + x);
        for (int k = 1; k <= reach; k++) {
            const u8l left = ((__global const u8l_unaligned *)(line + x - k))->v;
            const u8l right = ((__global const u8l_unaligned *)(line + x + k))->v;
            const u8l both = MAXIMUM(left, right);
            maximum = MAXIMUM(maximum, both);
        }
        *(__global u8l *)(to + x) = maximum;
    }
}

static void clear_lines(__global uchar *lines, uint bytes) {
    for (uint x = 0; x < bytes; x += LANES) *(__global u8l *)(lines + x) = (u8l)(0);
}

/* Sets the levels of a row of rays in layer `z` to 0 where it was not scanned, and counts those of inner
 * rays. */
static void mask_row(const sv_wall_layout *l, __global ushort *rays, uint z, uint row, __global uchar *levels,
                     uint histogram[4][256]) {
    const i16l at = (i16l)((short)z);
    __global const i16l *first = (__global const i16l *)ray_row(rays, l, RAY_FIRST, row);
    __global const i16l *end = (__global const i16l *)ray_row(rays, l, RAY_END, row);
    __global u8l *here = (__global u8l *)(levels + level_row(l, z, row));
    const bool counts = !l->smoothed && is_inner(row, l->rows);
    for (uint x = 0; x < vectors_of(l); x++) {
        const i16l scanned = (first[x] <= at) & (end[x] > at);
        const u8l level = here[x] & bytes_of(scanned);
        here[x] = level;
        if (counts) count_levels(histogram, level, scanned, x * LANES, l->columns);
    }
}

/* One work item per row of cells. Levels of blocks that were not scanned become 0. `bounded`: the pixels
 * have ranges. `row_maxima`: the means' dilation along x. `scratch`: scratch_words words of 32 bits for each
 * row. If wall_smooth follows, that kernel counts the levels. */
__kernel void wall_blocks(sv_wall_layout l, uint bounded, uint pitch, uint scratch_words,
                          __global const sv_wall_span *restrict spans, __global const ushort *restrict ranges,
                          __global uchar *restrict levels, __global ushort *restrict rays,
                          __global uint *restrict scratch, __global uchar *restrict row_maxima,
                          __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0), line_pitch = padded_cells_of(&l) + 2 * MARGIN;
    /* three lines alternate, for a vector that was just stored is slow to load in parts */
    __global uchar *lines = (__global uchar *)(scratch + (size_t)row * scratch_words);
    uint histogram[4][256];
    clear_counts(histogram);
    clear_lines(lines, 3 * line_pitch);
    lines += MARGIN;
    histograms += (size_t)row * HISTOGRAM_WORDS;
    histograms[HISTOGRAM_RAYS] = find_ranges(&l, 2 * row, bounded, pitch, spans, ranges, rays) +
                                 find_ranges(&l, 2 * row + 1, bounded, pitch, spans, ranges, rays);
    for (uint z = 0; z < l.layers + 2; z++) { /* zeros lie behind the last layer */
        for (uint r = 0; z < l.layers && r < 2; r++) mask_row(&l, rays, z, 2 * row + r, levels, histogram);
        if (z > 1) dilate_line(&l, lines + (z - 2) % 3 * line_pitch, row_maxima + cell_row(&l, z - 2, row));
        if (z > 0 && z <= l.layers)
            maximum_of_cells(&l, levels, z - 1, row, lines + (z - 1) % 3 * line_pitch);
    }
    if (!l.smoothed) store_counts(histogram, histograms);
}
