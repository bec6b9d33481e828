/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface by work items, along the rays: how bright they are, their first tissue, and how bright
 * that is where it is the wall.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* One work item per cell. `bright`: the largest of `beside` over the rows beside every cell. */
__kernel void wall_items_bright(sv_wall_layout l, __global const uint *restrict info,
                                __global const uchar *restrict beside, __global uchar *restrict bright) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    uint most = 0;
    for (uint y = row - min(row, l.beside[1]); y <= min(row + l.beside[1], l.cells[1] - 1); y++)
        most = max(most, (uint)beside[cell_row(&l, z, y) + x]);
    bright[cell_row(&l, z, row) + x] = (uchar)most;
}

/* The first tissue of a ray. */
typedef struct {
    uint begin, end, most;
} run_t;

/* `levels`, `bright`: the first layer of the ray and of its cell. Without tissue the run is empty and lies at
 * the end of the scan. */
static run_t first_run(const sv_wall_layout *l, __global const uchar *levels, __global const uchar *bright,
                       uint threshold, uint end) {
    const size_t level_pitch = level_row(l, 1, 0) - level_row(l, 0, 0), pitch = cell_row(l, 1, 0);
    uint z = 0;
    while (z < l->layers && levels[z * level_pitch] <= threshold) z++;
    run_t run = {z < l->layers ? z : end, end, 0};
    for (; z < l->layers && levels[z * level_pitch] > threshold; z++)
        run.most = max(run.most, (uint)bright[z * pitch]);
    if (z < l->layers) run.end = z;
    return run;
}

/* One work group per row of cells. A ray begins in the wall if it begins in tissue with fluid behind it. */
__kernel void wall_items_walls(sv_wall_layout l, __global const uint *restrict info,
                               __global const uchar *restrict levels, __global const uchar *restrict bright,
                               __global ushort *restrict rays, __global uint *restrict histograms) {
    __local uint counts[HISTOGRAM_WORDS];
    const uint threshold = info[INFO_TISSUE];
    const uint count = info[INFO_OUTCOME] == SV_WALL_SURFACE ? 2 * l.columns : 0;
    clear_counts(counts);
    for (uint i = (uint)get_local_id(0); i < count; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        const uint first = rays[block_row(&l, RAY_FIRST, at.row) + at.x];
        const uint end = rays[block_row(&l, RAY_END, at.row) + at.x];
        const run_t run = first_run(&l, levels + level_row(&l, 0, at.row) + at.x,
                                    bright + cell_row(&l, 0, at.row / 2) + at.x / 2, threshold, end);
        rays[block_row(&l, RAY_RUN, at.row) + at.x] = (ushort)run.begin;
        rays[block_row(&l, RAY_RUN_END, at.row) + at.x] = (ushort)run.end;
        if (run.begin == first && run.end > run.begin && run.end < end) {
            atomic_inc(counts + HISTOGRAM_WALL_RAYS);
            atomic_inc(counts + run.most);
        }
    }
    leave_counts(counts, HISTOGRAM_WALL_RAYS, histograms + get_group_id(0) * HISTOGRAM_WORDS);
}
