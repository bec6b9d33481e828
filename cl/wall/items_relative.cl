/* SPDX-License-Identifier: MIT */
/*
 * By work items: levels relative to the threshold around them. Sums and counts of bright blocks over windows
 * of cells share a word until they are summed over layers.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* One work item per cell: its bright blocks and those of the cells near it in its row. */
__kernel void wall_items_bright(sv_wall_layout l, __global const uint *restrict info,
                                __global const uchar *restrict levels, __global uint *restrict windows) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const uint from = x - min(x, l.window[0]), to = min(x + l.window[0], l.cells[0] - 1);
    uint words = 0;
    for (uint r = 2 * row; r < 2 * row + 2; r++) {
        __global const uchar *line = levels + level_row(&l, z, r);
        for (uint k = 2 * from; k < 2 * to + 2; k++)
            words += line[k] > info[SV_WALL_INFO_THRESHOLD] ? line[k] + (1u << SV_WALL_SUM_BITS) : 0;
    }
    windows[cell_row(&l, z, row) + x] = words;
}

/* One work item per cell, after wall_items_bright: the sums over the rows near it. */
__kernel void wall_items_bright_rows(sv_wall_layout l, __global const uint *restrict info,
                                     __global const uint *restrict windows, __global uint *restrict sums) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    uint words = 0;
    for (uint y = row - min(row, l.window[1]); y <= min(row + l.window[1], l.cells[1] - 1); y++)
        words += windows[cell_row(&l, z, y) + x];
    sums[cell_row(&l, z, row) + x] = words;
}

/* One work item per cell, after wall_items_bright_rows: the relative levels of its rays. */
__kernel void wall_items_relative(sv_wall_layout l, __global const uint *restrict info,
                                  __global const uint *restrict sums, __global const uchar *restrict levels,
                                  __global uchar *restrict relative) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    uint sum = 0, count = 0;
    for (uint i = z - min(z, l.window[2]); i <= min(z + l.window[2], l.layers - 1); i++) {
        const uint words = sums[cell_row(&l, i, row) + x];
        sum += words & ((1u << SV_WALL_SUM_BITS) - 1u);
        count += words >> SV_WALL_SUM_BITS;
    }
    const uint all = l.bright_blocks * info[SV_WALL_INFO_BRIGHT] / (SV_WALL_LEVEL_ONE / SV_WALL_BRIGHT_ONE);
    const uint mean = (sum * SV_WALL_BRIGHT_ONE + all) / (count + l.bright_blocks);
    const uint gain = info[SV_WALL_INFO_GAINS + max(mean, info[SV_WALL_INFO_THRESHOLD] * SV_WALL_BRIGHT_ONE)];
    for (uint i = 0; i < 4; i++) {
        const size_t at = level_row(&l, z, 2 * row + i / 2) + 2 * x + i % 2;
        relative[at] = (uchar)min(levels[at] * gain >> SV_WALL_GAIN_BITS, 255u);
    }
}

/* One work group per row of cells: counts the rays that begin with a few dark layers. */
__kernel void wall_items_near_field(sv_wall_layout l, __global const uint *restrict info,
                                    __global const uchar *restrict relative,
                                    __global const ushort *restrict rays, __global uint *restrict fronts) {
    __local uint sum;
    const uint item = (uint)get_local_id(0);
    const uint count = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE ? 2 * l.columns : 0;
    if (item == 0) sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < count; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        const uint first = rays[block_row(&l, RAY_FIRST, at.row) + at.x];
        const uint end = rays[block_row(&l, RAY_END, at.row) + at.x];
        if (behind_near_field(&l, relative + level_row(&l, 0, at.row) + at.x, first, end) > first)
            atomic_inc(&sum);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) fronts[get_group_id(0)] = sum;
}
