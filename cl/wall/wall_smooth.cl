/* SPDX-License-Identifier: MIT */
/*
 * Smooths layers of one slice along the rays. Such a block is more speckle than tissue, so its two neighbours
 * weigh 1 / SV_WALL_AXIAL_SUM each. Tissue is classified by the smoothed levels.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_HISTOGRAM_CLH
#include "wall/wall_histogram.clh"
#endif

/* Smooths and counts a row of rays. */
static void smooth_row(const sv_wall_layout *l, __global const uchar *levels, __global ushort *rays, uint row,
                       __global uchar *smoothed, uint histogram[4][256]) {
    for (uint x = 0; x < vectors_of(l); x++) {
        const i16l first = AS_I16(ray_row(rays, l, RAY_FIRST, row)[x]);
        const i16l end = AS_I16(ray_row(rays, l, RAY_END, row)[x]);
        u16l before = (u16l)(0), own = before;
        u16l behind = TO_U16(((__global const u8l *)(levels + level_row(l, 0, row)))[x]);
        for (uint z = 0; z < l->layers; z++) { /* zeros lie behind the last layer */
            const i16l at = (i16l)((short)z), scanned = (first <= at) & (end > at);
            before = own;
            own = behind;
            behind = TO_U16(((__global const u8l *)(levels + level_row(l, z + 1, row)))[x]);
            const u16l left = SELECT(own, before, AS_U16(first < at)),
                       right = SELECT(own, behind, AS_U16(end > at + (short)1));
            const u16l sum = own * (ushort)(SV_WALL_AXIAL_SUM - 2) + left + right;
            const u8l level = TO_U8((sum + (ushort)(SV_WALL_AXIAL_SUM / 2)) / (ushort)SV_WALL_AXIAL_SUM) &
                              bytes_of(scanned);
            ((__global u8l *)(smoothed + level_row(l, z, row)))[x] = level;
            if (is_inner(row, l->rows)) count_levels(histogram, level, scanned, x * LANES, l->columns);
        }
    }
}

/* One work item per row of cells, after wall_blocks, if layers are one slice. `smoothed` is laid out like
 * `levels`. A block that was not scanned counts as its neighbour. */
__kernel void wall_smooth(sv_wall_layout l, __global const uchar *restrict levels,
                          __global ushort *restrict rays, __global uchar *restrict smoothed,
                          __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0);
    uint histogram[4][256];
    clear_counts(histogram);
    for (uint r = 0; r < 2; r++) smooth_row(&l, levels, rays, 2 * row + r, smoothed, histogram);
    store_counts(histogram, histograms + (size_t)row * HISTOGRAM_WORDS);
}
