/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface by work items, along the rays: how bright they are, their first tissue, and how bright
 * that is where it is the wall; then what the wall encloses.
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
    const size_t level_pitch = level_pitch_of(l), pitch = cell_row(l, 1, 0);
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

/* A cell of a layer, from its four rays: CELL_TISSUE and CELL_WALL. */
static uchar kind_of(const sv_wall_layout *l, __global const uchar *levels, __global const ushort *rays,
                     uint threshold, uint z, uint row, uint x) {
    uint tissue = 0, wall = 0;
    for (uint i = 0; i < 4; i++) {
        const uint line = 2 * row + i / 2, column = 2 * x + i % 2;
        if (levels[level_row(l, z, line) + column] <= threshold) continue;
        const bool touches =
            rays[block_row(l, RAY_RUN, line) + column] == rays[block_row(l, RAY_FIRST, line) + column];
        tissue++;
        wall += touches && z < rays[block_row(l, RAY_RUN_END, line) + column];
    }
    return (uchar)((tissue >= SV_WALL_MOST_RAYS ? CELL_TISSUE : 0) |
                   (wall >= SV_WALL_MOST_RAYS ? CELL_WALL : 0));
}

/* Whether the wall is reached in a cell, after it was or was not in the one before. */
static bool goes_on(uchar cell, bool reached) {
    return (cell & CELL_TISSUE) && ((cell & CELL_WALL) || reached);
}

/* One work group per layer: which cells the wall encloses, all bits or none. Its work items take rows in
 * turns, then columns. */
__kernel void wall_items_enclose(sv_wall_layout l, __global const uint *restrict info,
                                 __global const uchar *restrict levels, __global const ushort *restrict rays,
                                 __global uchar *restrict enclosed) {
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), z = (uint)get_group_id(0);
    const bool wanted = info[INFO_OUTCOME] == SV_WALL_SURFACE;
    const uint threshold = info[INFO_TISSUE], rows = wanted ? l.cells[1] : 0,
               columns = wanted ? l.cells[0] : 0;
    for (uint y = item; y < rows; y += items) {
        __global uchar *const line = enclosed + cell_row(&l, z, y);
        bool reached = false;
        for (uint x = 0; x < columns; x++) {
            const uchar cell = kind_of(&l, levels, rays, threshold, z, y, x);
            reached = goes_on(cell, reached);
            line[x] = (uchar)(cell | (reached ? CELL_ACROSS : 0));
        }
        reached = false;
        for (uint x = columns; x-- > 0;) {
            reached = goes_on(line[x], reached);
            if (!reached) line[x] &= (uchar)~CELL_ACROSS;
        }
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint x = item; x < columns; x += items) {
        bool reached = false;
        for (uint y = 0; y < rows; y++) {
            __global uchar *const cell = enclosed + cell_row(&l, z, y) + x;
            reached = goes_on(*cell, reached);
            if (reached) *cell |= CELL_DOWN;
        }
        reached = false;
        for (uint y = rows; y-- > 0;) {
            __global uchar *const cell = enclosed + cell_row(&l, z, y) + x;
            reached = goes_on(*cell, reached);
            *cell = reached && (*cell & CELL_ACROSS) && (*cell & CELL_DOWN) ? 255 : 0;
        }
    }
}
