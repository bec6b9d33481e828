/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface by work items, blocks: which of them were scanned, their histogram, and the brightest
 * beside every ray; and blocks of one voxel, smoothed.
 */
#ifndef SV_WALL_SLICES_CLH
#include "wall/wall_slices.clh"
#endif
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* One work group per row of rays. Levels of blocks that were not scanned become 0. `bounded`: the pixels have
 * ranges. Where wall_items_steady follows, that counts the levels. */
__kernel void wall_items_blocks(sv_wall_layout l, uint bounded, uint pitch,
                                __global const sv_wall_span *restrict spans,
                                __global const ushort *restrict ranges, __global uchar *restrict levels,
                                __global ushort *restrict rays, __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    const uint row = (uint)get_group_id(0);
    const bool steadied = is_steadied(&l);
    const sv_wall_span along = spans[l.columns + row];
    clear_counts(counts);
    for (uint x = (uint)get_local_id(0); x < l.columns; x += (uint)get_local_size(0)) {
        ushort first = 0, end = (ushort)l.layers;
        if (bounded) {
            const sv_wall_span across = spans[x];
            find_range(&l, &across, &along, pitch, ranges, &first, &end);
        }
        rays[block_row(&l, RAY_FIRST, row) + x] = first;
        rays[block_row(&l, RAY_END, row) + x] = end;
        if (end > first) atomic_inc(counts + HISTOGRAM_RAYS);
        for (uint z = 0; z < l.layers; z++) {
            __global uchar *level = levels + level_row(&l, z, row) + x;
            const bool scanned = z >= first && z < end;
            if (!scanned) *level = 0;
            if (scanned && !steadied) atomic_inc(counts + *level);
        }
    }
    leave_counts(counts, HISTOGRAM_RAYS, histograms + (size_t)row * HISTOGRAM_WORDS);
}

/* The level beside a block of level `own`, at a column, row and layer that may lie outside. */
static uint level_beside(const sv_wall_layout *l, __global const uchar *levels, __global const ushort *rays,
                         int x, int row, int z, uint own) {
    if (x < 0 || x >= (int)l->columns || row < 0 || row >= (int)l->rows) return own;
    __global const ushort *ray = rays + block_row(l, RAY_FIRST, (uint)row) + x;
    const int first = (int)ray[0], end = (int)ray[block_row(l, RAY_END, 0)];
    return z >= first && z < end ? levels[level_row(l, (uint)z, (uint)row) + x] : own;
}

/* One work group per row of rays, after wall_items_blocks: `steady` lies as `levels` do. Only where there are
 * blocks of one voxel. */
__kernel void wall_items_steady(sv_wall_layout l, __global const uchar *restrict levels,
                                __global const ushort *restrict rays, __global uchar *restrict steady,
                                __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    const int row = (int)get_group_id(0);
    clear_counts(counts);
    for (int x = (int)get_local_id(0); x < (int)l.columns; x += (int)get_local_size(0))
        for (int z = 0; z < (int)l.layers; z++) {
            const uint none = 256, own = level_beside(&l, levels, rays, x, row, z, none);
            const size_t at = level_row(&l, (uint)z, (uint)row) + (uint)x;
            uint sum = SV_WALL_STEADY * own;
            for (int axis = 0; axis < 3; axis++) {
                const int dx = axis == 0, dy = axis == 1, dz = axis == 2;
                if (l.single[axis])
                    sum += level_beside(&l, levels, rays, x - dx, row - dy, z - dz, own) +
                           level_beside(&l, levels, rays, x + dx, row + dy, z + dz, own) - 2 * own;
            }
            const uint mean = own == none ? 0 : (sum + SV_WALL_STEADY / 2) / SV_WALL_STEADY;
            steady[at] = (uchar)mean;
            if (own != none) atomic_inc(counts + mean);
        }
    leave_counts(counts, NO_EXTRA, histograms + (size_t)row * HISTOGRAM_WORDS);
}

/* One work item per block. `beside`: the largest mean of a block and the one behind it, over those of the row
 * beside every ray. Zeros lie behind the last layer. */
__kernel void wall_items_beside(sv_wall_layout l, __global const uchar *restrict levels,
                                __global uchar *restrict beside) {
    const uint x = (uint)get_global_id(0), row = row_of_block(&l), z = layer_of_block(&l);
    if (x >= l.columns) return;
    __global const uchar *at = levels + level_row(&l, z, row), *behind = levels + level_row(&l, z + 1, row);
    uint most = 0;
    for (uint k = x - min(x, l.beside[0]); k <= min(x + l.beside[0], l.columns - 1); k++)
        most = max(most, (at[k] + behind[k] + 1u) / 2u);
    beside[block_row(&l, z, row) + x] = (uchar)most;
}
