/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, from costs to the cheapest layer of every ray: the lateral Gaussian, the least, and the
 * mean around it. Beyond the border the ray at the border counts.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* Costs are summed up in lines of float32, which hold all sums exactly, with this much before and behind
 * them. */
#define LINE_MARGIN SV_WALL_KERNEL
#define FINE        (SV_WALL_KERNEL_ONE * SV_WALL_KERNEL_ONE / (SV_WALL_FINE_ONE / SV_WALL_ONE))

static __global const u16l *costs_at(const sv_wall_layout *l, __global const ushort *costs, uint z, int row) {
    return (__global const u16l *)(costs + block_row(l, z, (uint)clamp(row, 0, (int)l->rows - 1)));
}

/* The Gaussian along y of layer z of a row, and its border values before and behind it. */
static void sum_rows_of(const sv_wall_layout *l, __global const ushort *costs, uint z, int row,
                        __global float *line) {
    for (uint x = 0; x < vectors_of(l); x++) {
        f32l sum = TO_F32(costs_at(l, costs, z, row)[x]) * (float)l->kernel_y[0];
        for (int k = 1; k <= (int)l->reach_y; k++) {
            const u16l pair = costs_at(l, costs, z, row - k)[x] + costs_at(l, costs, z, row + k)[x];
            sum += TO_F32(pair) * (float)l->kernel_y[k];
        }
        ((__global f32l *)line)[x] = sum;
    }
    for (uint k = 1; k <= l->reach_x; k++) {
        line[-(int)k] = line[0];
        line[l->columns - 1 + k] = line[l->columns - 1];
    }
}

/* The Gaussian along x of a line, rounded half up. */
static void sum_columns(const sv_wall_layout *l, __global const float *line, __global u32l *to) {
    for (uint x = 0; x < vectors_of(l); x++) {
        __global const float *at = line + x * LANES;
        f32l sum = *(__global const f32l *)at * (float)l->kernel_x[0];
        for (uint k = 1; k <= l->reach_x; k++) {
            const f32l left = ((__global const f32l_anywhere *)(at - k))->v;
            const f32l right = ((__global const f32l_anywhere *)(at + k))->v;
            sum += (left + right) * (float)l->kernel_x[k];
        }
        to[x] = (TO_U32(sum) + FINE / 2u) / FINE;
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
        const i32l in = cost<limit, before = best>(u32l)(z);
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
    __global float *lines = (__global float *)scratch + LINE_MARGIN;
    __global u32l *sums = (__global u32l *)(scratch + 2 * (pitch + 2 * LINE_MARGIN));
    for (uint z = 0; z <= l.layers; z++) {
        if (z < l.layers) sum_rows_of(&l, costs, z, (int)row, lines + (z & 1) * (pitch + 2 * LINE_MARGIN));
        if (z > 0) sum_columns(&l, lines + (~z & 1) * (pitch + 2 * LINE_MARGIN), sums + (z - 1) * vectors);
    }
    for (uint x = 0; x < vectors; x++) cheapest(&l, sums + x, places + block_row(&l, 0, row) + x * LANES);
}
