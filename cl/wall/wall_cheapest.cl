/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, from costs to the cheapest layer of every ray: the lateral Gaussian, the least, the
 * mean around it, and how far around it the knob may go. Beyond the border the ray at the border counts.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif

/* Costs are summed up in lines of float32, which hold all sums exactly, with this much before and behind
 * them. */
#define LINE_MARGIN SV_WALL_KERNEL

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

/* LANES rays: the cheapest layer, of several the one nearest to the viewer. */
static u32l cheapest(const sv_wall_layout *l, __global const u32l *costs, u32l *least) {
    const uint pitch = vectors_of(l);
    u32l best = (u32l)(0);
    *least = costs[0];
    for (uint z = 1; z < l->layers; z++) {
        const u32l cost = costs[z * pitch];
        const i32l less = cost < *least;
        *least = PICK(*least, cost, less);
        best = PICK(best, (u32l)(z), less);
    }
    return best;
}

/* The mean of the layers around the cheapest one that cost less than the limit, weighted by what they cost
 * less than that. */
static f32l mean_around(const sv_wall_layout *l, __global const u32l *costs, u32l best, u32l limit) {
    const uint pitch = vectors_of(l);
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
    f32l mean;
    for (uint i = 0; i < LANES; i++) {
        const uint w = ((const uint *)&weight)[i];
        const float quotient = (float)((const uint *)&sum)[i] / (float)(w ? w : 1u);
        ((float *)&mean)[i] = w ? quotient : (float)((const uint *)&best)[i];
    }
    return mean;
}

/* Layers beside the cheapest one whose costs are less than a limit, up to `last`; and the costs of that and
 * of the one behind it. */
typedef struct {
    u32l last, inside, outside;
} end_t;

/* Where the costs between two layers cross the limit, from `inside` on. */
static f32l crossing(const end_t *e, u32l limit) {
    return TO_F32(limit - e->inside) / TO_F32(e->outside - e->inside);
}

/* How far around the cheapest layer the costs stay below the limit, but not beyond `place`. */
static void find_ends(const sv_wall_layout *l, __global const u32l *costs, u32l best, u32l limit, f32l place,
                      __global f32l *near, __global f32l *far) {
    const uint pitch = vectors_of(l);
    end_t before = {(u32l)(0), limit, limit + 1u}, behind = {(u32l)(l->layers - 1), limit, limit + 1u};
    i32l over = (i32l)(0);
    for (uint z = 1; z < l->layers; z++) {
        const u32l last = costs[(z - 1) * pitch], cost = costs[z * pitch];
        const i32l enters = (last >= limit) & (cost < limit) & (best >= (u32l)(z));
        const i32l leaves = (last < limit) & (cost >= limit) & (best < (u32l)(z)) & ~over;
        before.last = PICK(before.last, (u32l)(z), enters);
        before.inside = PICK(before.inside, cost, enters);
        before.outside = PICK(before.outside, last, enters);
        behind.last = PICK(behind.last, (u32l)(z - 1), leaves);
        behind.inside = PICK(behind.inside, last, leaves);
        behind.outside = PICK(behind.outside, cost, leaves);
        over |= leaves;
    }
    const f32l first = TO_F32(before.last) - crossing(&before, limit);
    const f32l end = TO_F32(behind.last) + crossing(&behind, limit);
    *near = LEAST(first, place);
    *far = MOST(end, place);
}

/* LANES rays; `places` is where they lie in the first plane. */
static void place(const sv_wall_layout *l, __global const u32l *costs, __global float *places) {
    const size_t plane = place_row(l, 1, 0);
    u32l least;
    const u32l best = cheapest(l, costs, &least);
    const f32l mean = mean_around(l, costs, best, least + l->slack);
    *(__global f32l *)(places + PLACE_LAYER * plane) = mean;
    find_ends(l, costs, best, least + l->reach, mean, (__global f32l *)(places + PLACE_NEAR * plane),
              (__global f32l *)(places + PLACE_FAR * plane));
}

/* One work item per row of rays. `scratch`: words of 32 bits, scratch_words a row. `places`: the planes
 * of the layers, and of the ends around them. */
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
    for (uint x = 0; x < vectors; x++) place(&l, sums + x, places + place_row(&l, 0, row) + x * LANES);
}
