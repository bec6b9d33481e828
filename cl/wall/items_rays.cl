/* SPDX-License-Identifier: MIT */
/*
 * By work items, along the rays: the brightness of cells, the first run of each ray, and the brightness of
 * the wall; then what surrounds tissue.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* One work item per cell: the dilation along y. */
__kernel void wall_items_dilate_columns(sv_wall_layout l, __global const uint *restrict info,
                                        __global const uchar *restrict row_maxima,
                                        __global uchar *restrict brightness) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    uint maximum = 0;
    for (uint y = row - min(row, l.dilation[1]); y <= min(row + l.dilation[1], l.cells[1] - 1); y++)
        maximum = max(maximum, (uint)row_maxima[cell_row(&l, z, y) + x]);
    brightness[cell_row(&l, z, row) + x] = (uchar)maximum;
}

/* The first run of a ray. */
typedef struct {
    uint begin, end, maximum;
} run_t;

/* Finds the first run; the brightness of the skin counts only if the run has nothing else. `levels`,
 * `brightness`: the first layer of the ray and of its cell. Without tissue the run is empty and lies at the
 * end of the scan. */
static run_t first_run(const sv_wall_layout *l, __global const uchar *levels,
                       __global const uchar *brightness, uint end) {
    const size_t level_pitch = level_pitch_of(l), pitch = cell_row(l, 1, 0);
    uint z = 0;
    while (z < l->layers && levels[z * level_pitch] <= SV_WALL_TISSUE) z++;
    run_t run = {z < l->layers ? z : end, end, 0};
    const uint behind_skin = z + l->skin;
    uint last = 0;
    for (; z < l->layers && levels[z * level_pitch] > SV_WALL_TISSUE; z++) {
        last = brightness[z * pitch];
        if (z >= behind_skin) run.maximum = max(run.maximum, last);
    }
    if (z <= behind_skin) run.maximum = last;
    if (z < l->layers) run.end = z;
    return run;
}

/* Dim blocks at the start of a ray's scan are tissue. */
static void fill_dim_front(const sv_wall_layout *l, __global uchar *levels, uint first, uint end) {
    const size_t pitch = level_pitch_of(l);
    for (uint z = first; z < end; z++) {
        const uint level = levels[z * pitch];
        if (level <= l->dim || level > SV_WALL_TISSUE) break;
        levels[z * pitch] = SV_WALL_DIM_TISSUE;
    }
}

/* The sum of the levels of a ray and of those around it. */
static uint sum_around(const sv_wall_layout *l, __global const uchar *levels, uint z, ray_place_t at) {
    const uint reach = SV_WALL_VALLEY_REACH;
    uint sum = 0;
    for (uint y = at.row - min(at.row, reach); y <= min(at.row + reach, l->rows - 1); y++)
        for (uint x = at.x - min(at.x, reach); x <= min(at.x + reach, l->columns - 1); x++)
            sum += levels[level_row(l, z, y) + x];
    return sum;
}

/* The largest of these sums in layers from .. to - 1, or 0. */
static uint largest_sum(const sv_wall_layout *l, __global const uchar *levels, uint from, uint to,
                        ray_place_t at) {
    uint largest = 0;
    for (uint z = from; z < to; z++) largest = max(largest, sum_around(l, levels, z, at));
    return largest;
}

/* Valleys of the brightness part a first run (sv_wall_part_valleys). `relative`: of the ray. */
static void part_valleys(const sv_wall_layout *l, __global const uchar *levels, __global uchar *relative,
                         uint first, uint scan_end, ray_place_t at) {
    const size_t pitch = level_pitch_of(l);
    uint end = first;
    while (end < scan_end && relative[end * pitch] > SV_WALL_TISSUE) end++;
    if (end == scan_end || l->valley == 0) return;
    const uint from = max(end - min(end, l->full_distance), first + l->skin);
    uint before = from < end ? largest_sum(l, levels, first, from, at) : 0;
    for (uint z = from; z < end; z++) {
        const uint sum = sum_around(l, levels, z, at), low = sum * SV_WALL_VALLEY_ONE;
        /* What lies behind costs most, and few layers are that much darker than what lies before. */
        if (low < before * l->valley && low < largest_sum(l, levels, z + 1, end, at) * l->valley)
            relative[z * pitch] = SV_WALL_TISSUE;
        before = max(before, sum);
    }
}

/* One work group per row of cells. A ray begins in the wall if it begins in tissue with fluid behind it.
 * `levels`: relative ones, of `grey`. */
__kernel void wall_items_first_runs(sv_wall_layout l, __global const uint *restrict info,
                                    __global const uchar *restrict grey, __global uchar *restrict levels,
                                    __global const uchar *restrict brightness, __global ushort *restrict rays,
                                    __global uint *restrict histograms,
                                    __global const uint *restrict fronts) {
    __local uint counts[HISTOGRAM_WORDS];
    const uint count = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE ? 2 * l.columns : 0;
    const bool near_field = count > 0 && has_near_field(&l, fronts, info[SV_WALL_INFO_RAYS]);
    clear_counts(counts);
    for (uint i = (uint)get_local_id(0); i < count; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        uint first = rays[block_row(&l, RAY_FIRST, at.row) + at.x];
        const uint end = rays[block_row(&l, RAY_END, at.row) + at.x];
        __global uchar *const ray = levels + level_row(&l, 0, at.row) + at.x;
        if (near_field) first = behind_near_field(&l, ray, first, end);
        fill_dim_front(&l, ray, first, end);
        part_valleys(&l, grey, ray, first, end, at);
        const run_t run = first_run(&l, ray, brightness + cell_row(&l, 0, at.row / 2) + at.x / 2, end);
        rays[block_row(&l, RAY_FIRST, at.row) + at.x] = (ushort)first;
        rays[block_row(&l, RAY_RUN, at.row) + at.x] = (ushort)run.begin;
        rays[block_row(&l, RAY_RUN_END, at.row) + at.x] = (ushort)run.end;
        if (run.begin == first && run.end > run.begin && run.end < end) {
            atomic_inc(counts + HISTOGRAM_WALL_RAYS);
            atomic_inc(counts + run.maximum);
        }
    }
    store_counts(counts, HISTOGRAM_WALL_RAYS, histograms + get_group_id(0) * HISTOGRAM_WORDS);
}

/* Classifies a cell of a layer by its four rays: CELL_TISSUE and CELL_WALL; CELL_FETUS if it is tissue of a
 * later run. */
static uchar kind_of(const sv_wall_layout *l, __global const uchar *levels, __global const ushort *rays,
                     uint z, uint row, uint x) {
    uint tissue = 0, wall = 0;
    _Pragma("unroll") for (uint i = 0; i < 4; i++) {
        const uint line = 2 * row + i / 2, column = 2 * x + i % 2;
        const uint begin = rays[block_row(l, RAY_RUN, line) + column];
        const uint first = rays[block_row(l, RAY_FIRST, line) + column];
        const uint end = rays[block_row(l, RAY_RUN_END, line) + column];
        const uint is_tissue = levels[level_row(l, z, line) + column] > SV_WALL_TISSUE;
        tissue += is_tissue;
        wall += is_tissue & (uint)(begin == first) & (uint)(z < end);
    }
    return (uchar)((tissue >= SV_WALL_MAJORITY ? CELL_TISSUE : 0) |
                   (wall >= SV_WALL_MAJORITY ? CELL_WALL : 0) |
                   (tissue - wall >= SV_WALL_MAJORITY ? CELL_FETUS : 0));
}

/* Whether a sweep reaches the cell; `before`: whether it reached the one before it. Of && and || LLVM 18
 * makes selects of a bool that the loop carries, and PoCL 6.0 then aborts (docs/architecture.md). */
static bool reaches(uint cell, uint source, bool before) {
    return ((cell & CELL_TISSUE) != 0) & (((cell & source) != 0) | before);
}

/* Sweeps over `count` cells, `step` apart. Cells that `source` reaches through tissue in this direction get
 * CELL_REACHED; the others lose it. */
static void sweep(__global uchar *cells, size_t step, uint count, uint source) {
    bool reached = false;
    for (uint i = 0; i < count; i++) {
        __global uchar *const cell = cells + i * step;
        reached = reaches(*cell, source, reached);
        *cell = (uchar)((*cell & ~CELL_REACHED) | (reached ? CELL_REACHED : 0));
    }
}

/* Sweeps a line both ways: cells that `source` reaches from both sides get the bit `both`, from any side the
 * bit `any`. */
static void find_sides(__global uchar *cells, size_t step, uint count, uint source, uint both, uint any) {
    bool reached = false;
    sweep(cells, step, count, source);
    for (uint i = count; i-- > 0;) {
        __global uchar *const cell = cells + i * step;
        const bool there = (*cell & CELL_REACHED) != 0;
        reached = reaches(*cell, source, reached);
        *cell |= (uchar)((reached && there ? both : 0) | (reached || there ? any : 0));
    }
}

/* Sweeps a column both ways, after the rows: cells that the wall reaches from three sides are enclosed. */
static void find_enclosed(__global uchar *cells, size_t step, uint count) {
    bool reached = false;
    sweep(cells, step, count, CELL_WALL);
    for (uint i = count; i-- > 0;) {
        __global uchar *const cell = cells + i * step;
        const bool above = (*cell & CELL_REACHED) != 0, in_row = (*cell & CELL_WALL_IN_ROW) != 0;
        const bool beside = (*cell & CELL_WALL_BESIDE) != 0;
        reached = reaches(*cell, CELL_WALL, reached);
        const bool enclosed = (in_row & (above | reached)) | (beside & above & reached);
        *cell = (uchar)((*cell & ~(CELL_WALL_IN_ROW | CELL_WALL_BESIDE)) | (enclosed ? CELL_ENCLOSED : 0));
    }
}

/* Decides which cells of later runs in a column are the fetus. */
static void classify_fetus(const sv_wall_layout *l, __global uchar *cells, __global const uchar *brightness,
                           uint minimum, size_t pitch) {
    for (uint y = 0; y < l->cells[1]; y++) {
        __global uchar *const cell = cells + y * pitch;
        if ((*cell & CELL_ENCLOSED) || brightness[y * pitch] < minimum) *cell &= (uchar)~CELL_FETUS;
    }
}

/* One work group per layer: finds what surrounds tissue. Its work items take turns over rows, then columns,
 * then rows. */
__kernel void wall_items_surroundings(sv_wall_layout l, __global const uint *restrict info,
                                      __global const uchar *restrict levels,
                                      __global const uchar *restrict brightness,
                                      __global const ushort *restrict rays, __global uchar *restrict flags) {
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), z = (uint)get_group_id(0);
    const bool wanted = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    const uint minimum = info[SV_WALL_INFO_FETUS];
    const uint rows = wanted ? l.cells[1] : 0, columns = wanted ? l.cells[0] : 0;
    const size_t layer = cell_row(&l, z, 0), pitch = cell_row(&l, 0, 1);
    for (uint i = item; i < rows * columns; i += items)
        flags[layer + i / columns * pitch + i % columns] =
            kind_of(&l, levels, rays, z, i / columns, i % columns);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint y = item; y < rows; y += items)
        find_sides(flags + layer + y * pitch, 1, columns, CELL_WALL, CELL_WALL_IN_ROW, CELL_WALL_BESIDE);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint x = item; x < columns; x += items) {
        __global uchar *const column = flags + layer + x;
        find_enclosed(column, pitch, rows);
        classify_fetus(&l, column, brightness + layer + x, minimum, pitch);
        find_sides(column, pitch, rows, CELL_FETUS, CELL_FLANKED, CELL_ADJACENT);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (uint y = item; y < rows; y += items)
        find_sides(flags + layer + y * pitch, 1, columns, CELL_FETUS, CELL_FLANKED, CELL_ADJACENT);
}
