/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, from costs to the cheapest layer of every ray: the lateral Gaussian, the least, and the
 * mean around it. Beyond the border the ray at the border counts.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* Costs are summed up in lines of 32 bits with this much before and behind them. */
#define LINE_MARGIN SV_WALL_KERNEL
#define ROUNDED(sum) (((sum) + FINE / 2) / FINE) /* rounded half up */
#define FINE        (SV_WALL_KERNEL_ONE * SV_WALL_KERNEL_ONE / (SV_WALL_FINE_ONE / SV_WALL_ONE))

static const __global u16l *costs_at(const sv_wall_layout *l, __global const ushort *costs, uint z, int row) {
    return (__global const u16l *)(costs + block_row(l, z, (uint)clamp(row, 0, (int)l->rows - 1)));
}

/* The Gaussian along y of layer z of a row, and its border values before and behind it. */
static void sum_rows_of(const sv_wall_layout *l, __global const ushort *costs, uint z, uint row,
                        __global uint *line) {
    for (uint x = 0; x < vectors_of(l); x++) {
        u32l sum = TO_U32(costs_at(l, costs, z, (int)row)[x]) * l->kernel_y[0];
        for (uint k = 1; k <= l->reach_y; k++) {
            const u16l pair =
                costs_at(l, costs, z, (int)(row - k))[x] + costs_at(l, costs, z, (int)(row + k))[x];
            sum += TO_U32(pair) * l->kernel_y[k];
        }
        ((__global u32l *)line)[x] = sum;
    }
    for (uint k = 1; k <= l->reach_x; k++) {
        line[-(int)k] = line[0];
        line[l->columns - 1 + k] = line[l->columns - 1];
    }
}

/* The Gaussian along x of a line, rounded half up. */
static void sum_columns(const sv_wall_layout *l, __global const uint *line, __global u32l *to) {
    for (uint x = 0; x < vectors_of(l); x++) {
        __global const uint *at = line + x * LANES;
        u32l sum = *(__global const u32l *)at * l->kernel_x[0];
        for (uint k = 1; k <= l->reach_x; k++) {
            const u32l left = ((__global const u32l_anywhere *)(at - k))->v;
            const u32l right = ((__global const u32l_anywhere *)(at + k))->v;
            sum += (left + right) * l->kernel_x[k];
        }
        to[x] = ROUNDED(sum);
    }
}

/* LANES rays: the mean of the layers around the cheapest one that cost less than the limit, weighted by what
 * they cost less than that. */
static void cheapest(const sv_wall_layout *l, __global const u32l *costs, __global float *to) {
    const uint pitch = vectors_of(l);
    u32l least = costs[0], best = (u32l)(0);
    for (uint z = 1; z < l->layers; z++) {
        const u32l cost = costs[z * pitch];
        const i32l less = cost < least;
        least = PICK(least, cost, less);
        best = PICK(best, (u32l)(z), less);
    }
    const u32l limit = least + l->slack;
    u32l weight = (u32l)(0), sum = weight;
    i32l over = (i32l)(0);
    for (uint z = 0; z < l->layers; z++) {
        const u32l cost = costs[z * pitch];
        const i32l in = cost < limit, before = best > (u32l)(z);
        over |= ~in & ~before;
        const u32l less = (limit - cost) & AS_U32(in & ~over), keep = AS_U32(in | ~before);
        weight = (weight & keep) + less;
        sum = (sum & keep) + less * z;
    }
    for (uint i = 0; i < LANES; i++) {
        const uint w = ((const uint *)&weight)[i];
        const float mean = (float)((const uint *)&sum)[i] / (float)(w ? w : 1u);
        to[i] = w ? mean : (float)((const uint *)&best)[i];
    }
}

/* One work item per row of rays. `scratch`: words of 32 bits, scratch_words a row. `places`: the plane of the
 * cheapest layers. */
__kernel void wall_cheapest(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                            __global const ushort *restrict costs, __global uint *restrict scratch,
                            __global float *restrict places) {
    const uint row = (uint)get_global_id(0), vectors = vectors_of(&l), pitch = padded_columns_of(&l);
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    scratch += (size_t)row * scratch_words;
    /* two lines, in turns: a vector that was just stored is slow to load in parts */
    __global uint *lines = scratch + LINE_MARGIN;
    __global u32l *sums = (__global u32l *)(scratch + 2 * (pitch + 2 * LINE_MARGIN));
    for (uint z = 0; z <= l.layers; z++) {
        if (z < l.layers) sum_rows_of(&l, costs, z, row, lines + (z & 1) * (pitch + 2 * LINE_MARGIN));
        if (z > 0) sum_columns(&l, lines + (~z & 1) * (pitch + 2 * LINE_MARGIN), sums + (z - 1) * vectors);
    }
    for (uint x = 0; x < vectors; x++) cheapest(&l, sums + x, places + block_row(&l, 0, row) + x * LANES);
}
