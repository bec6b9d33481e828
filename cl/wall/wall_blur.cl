/* SPDX-License-Identifier: MIT */
/*
 * The lateral Gaussian over the costs of cells. Beyond the border the cell at the border counts.
 */
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
#endif

#pragma OPENCL FP_CONTRACT ON /* every sum here is exact */

/* Margin of the lines of float32 in which costs are summed up. They hold all sums exactly. */
#define LINE_MARGIN SV_WALL_KERNEL

/* Offsets of the costs of a row's first layer, and of the rows so far above and below it. */
typedef struct {
    size_t above[SV_WALL_KERNEL + 1], below[SV_WALL_KERNEL + 1];
} rows_t;

static void find_rows(const sv_wall_layout *l, int row, rows_t *at) {
    const int last = (int)l->cells[1] - 1;
    for (int k = 0; k <= (int)l->reach_y; k++) {
        at->above[k] = cell_row(l, 0, (uint)max(row - k, 0));
        at->below[k] = cell_row(l, 0, (uint)min(row + k, last));
    }
}

/* The Gaussian along y of a layer. The line gets its border values in its margins, too, behind the cells and
 * behind the vectors: what nobody reads must be a number, where a host lets exceptions trap. `costs`: the
 * layer in row 0. */
static void sum_rows_of(const sv_wall_layout *l, __global const ushort *costs, const rows_t *at,
                        __global float *line) {
    for (uint x = 0; x < padded_cells_of(l); x += LANES) {
        f32l sum = TO_F32(*(__global const u16l *)(costs + at->above[0] + x)) * (float)l->kernel_y[0];
        for (uint k = 1; k <= l->reach_y; k++) {
            const u16l above = *(__global const u16l *)(costs + at->above[k] + x);
            const u16l below = *(__global const u16l *)(costs + at->below[k] + x);
            sum += TO_F32(above + below) * (float)l->kernel_y[k];
        }
        *(__global f32l *)(line + x) = sum;
    }
    for (uint k = 1; k <= l->reach_x; k++) {
        line[-(int)k] = line[0];
        line[l->cells[0] - 1 + k] = line[padded_cells_of(l) - 1 + k] = line[l->cells[0] - 1];
    }
}

/* The Gaussian along x of a line, rounded half up. The row gets its border values in its margins, too. */
static void sum_columns(const sv_wall_layout *l, __global const float *line, __global ushort *to) {
    for (uint x = 0; x < padded_cells_of(l); x += LANES) {
        __global const float *at = line + x;
        f32l sum = *(__global const f32l *)at * (float)l->kernel_x[0];
        for (uint k = 1; k <= l->reach_x; k++) {
            const f32l left = ((__global const f32l_unaligned *)(at - k))->v;
            const f32l right = ((__global const f32l_unaligned *)(at + k))->v;
            sum += (left + right) * (float)l->kernel_x[k];
        }
        *(__global u16l *)(to + x) = TO_U16((TO_U32(sum) + FINE / 2u) / FINE);
    }
    to[-1] = to[0];
    to[l->cells[0]] = to[l->cells[0] - 1];
}

/* Gives other layers of a row what layer `z` has. */
static void repeat_layer(const sv_wall_layout *l, uint z, extent_t layers, uint row, __global ushort *fine) {
    __global const ushort *same = fine + fine_row(l, z, row);
    for (uint to = layers.from; to < layers.to; to++) {
        __global ushort *copy = fine + fine_row(l, to, row);
        for (uint x = 0; x < padded_cells_of(l); x += LANES)
            *(__global u16l *)(copy + x) = *(__global const u16l *)(same + x);
        copy[-1] = same[-1];
        copy[l->cells[0]] = same[l->cells[0]];
    }
}

/* One work item per row of cells. `scratch`: words of 32 bits, scratch_words a row. */
__kernel void wall_blur(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                        __global const ushort *restrict costs, __global ushort *restrict rays,
                        __global uint *restrict scratch, __global ushort *restrict fine) {
    const uint row = (uint)get_global_id(0), pitch = padded_cells_of(&l) + 2 * LINE_MARGIN;
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    /* two lines alternate, for a vector that was just stored is slow to load in parts */
    __global float *lines = (__global float *)(scratch + (size_t)row * scratch_words) + LINE_MARGIN;
    rows_t rows;
    find_rows(&l, (int)row, &rows);
    const extent_t layers = changing_near(&l, rays, row, l.reach_y);
    for (uint z = layers.from; z <= layers.to; z++) {
        if (z < layers.to) sum_rows_of(&l, costs + cell_row(&l, z, 0), &rows, lines + (z & 1) * pitch);
        if (z > layers.from) sum_columns(&l, lines + (~z & 1) * pitch, fine + fine_row(&l, z - 1, row));
    }
    repeat_layer(&l, layers.from, (extent_t){0, layers.from}, row, fine);
    repeat_layer(&l, layers.to - 1, (extent_t){layers.to, l.layers}, row, fine);
}

#pragma OPENCL FP_CONTRACT OFF
