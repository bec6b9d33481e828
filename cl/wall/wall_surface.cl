/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, from the costs of cells to the surface: the lateral Gaussian, the cheapest label, the
 * median, the confidence, and the way back to pixels. Beyond the border the cell at the border counts.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* Planes of a float32 a cell. */
#define CELL_LABEL  0 /* the cheapest; then the confidence */
#define CELL_CHOSEN 1 /* its median */
#define CELL_OWN    2 /* what the cell's own rays say of that */

static uint beside_cell(uint at, int step, uint count) {
    return (uint)clamp((int)at + step, 0, (int)count - 1);
}

/* One work item per row of cells: the Gaussian along x. */
__kernel void wall_blur(sv_wall_layout l, __global const uint *restrict info,
                        __global const uint16 *restrict costs, __global uint16 *restrict blurred) {
    const uint y = (uint)get_global_id(0), vectors = padded_labels_of(&l) / SV_LANES;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    costs += (size_t)y * l.cells_x * vectors;
    blurred += (size_t)y * l.cells_x * vectors;
    for (uint x = 0; x < l.cells_x; x++)
        for (uint i = 0; i < vectors; i++) {
            uint16 sum = l.kernel_x[0] * costs[x * vectors + i];
            for (uint k = 1; k <= l.reach_x; k++)
                sum += l.kernel_x[k] * (costs[beside_cell(x, -(int)k, l.cells_x) * vectors + i] +
                                        costs[beside_cell(x, (int)k, l.cells_x) * vectors + i]);
            blurred[x * vectors + i] = sum;
        }
}

/* The mean of the labels around the cheapest one that cost less than the limit, weighted by what they cost
 * less than that. */
static float cheapest(const sv_wall_layout *l, __global const uint *cost) {
    uint best = 0;
    for (uint i = 1; i < l->labels; i++)
        if (cost[i] < cost[best]) best = i;
    const uint limit = cost[best] + l->slack;
    ulong weight = l->slack, sum = (ulong)l->slack * best;
    for (uint i = best; i > 0 && cost[i - 1] < limit; i--) {
        weight += limit - cost[i - 1];
        sum += (ulong)(limit - cost[i - 1]) * (i - 1);
    }
    for (uint i = best + 1; i < l->labels && cost[i] < limit; i++) {
        weight += limit - cost[i];
        sum += (ulong)(limit - cost[i]) * i;
    }
    return weight ? (float)sum / (float)weight : (float)best;
}

/* One work item per row of cells: the Gaussian along y, rounded half up, and the cheapest label. `line`: the
 * costs of a cell, a row each. */
__kernel void wall_cheapest(sv_wall_layout l, __global const uint *restrict info,
                            __global const uint16 *restrict blurred, __global uint16 *restrict line,
                            __global float *restrict cells) {
    const uint y = (uint)get_global_id(0), vectors = padded_labels_of(&l) / SV_LANES;
    const uint one = SV_WALL_KERNEL_ONE * SV_WALL_KERNEL_ONE;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    line += (size_t)y * l.cells_x * vectors;
    for (uint x = 0; x < l.cells_x; x++) {
        for (uint i = 0; i < vectors; i++) {
            uint16 sum = l.kernel_y[0] * blurred[((size_t)y * l.cells_x + x) * vectors + i];
            for (uint k = 1; k <= l.reach_y; k++) {
                const size_t up = beside_cell(y, -(int)k, l.cells_y),
                             down = beside_cell(y, (int)k, l.cells_y);
                sum += l.kernel_y[k] * (blurred[(up * l.cells_x + x) * vectors + i] +
                                        blurred[(down * l.cells_x + x) * vectors + i]);
            }
            line[x * vectors + i] = (sum + one / 2) / one;
        }
        cells[(size_t)CELL_LABEL * l.cells_x * l.cells_y + (size_t)y * l.cells_x + x] =
            cheapest(&l, (__global const uint *)(line + x * vectors));
    }
}

/* A cell and its eight neighbours. */
static void neighbours(const sv_wall_layout *l, __global const float *map, uint x, uint y, float *out) {
    for (int v = -1; v <= 1; v++)
        for (int u = -1; u <= 1; u++)
            *out++ = map[(size_t)beside_cell(y, v, l->cells_y) * l->cells_x + beside_cell(x, u, l->cells_x)];
}

static float median(const sv_wall_layout *l, __global const float *map, uint x, uint y) {
    float values[9];
    neighbours(l, map, x, y, values);
    for (int i = 1; i < 9; i++)
        for (int k = i; k > 0 && values[k - 1] > values[k]; k--) {
            const float higher = values[k - 1];
            values[k - 1] = values[k];
            values[k] = higher;
        }
    return values[4];
}

/* One work item per row of cells: the median of the labels, and what the cell's own rays say of it. */
__kernel void wall_median(sv_wall_layout l, __global const uint *restrict info,
                          __global const uint *restrict costs, __global const uint *restrict aways,
                          __global float *restrict cells) {
    const uint y = (uint)get_global_id(0), padded = padded_labels_of(&l);
    const size_t plane = (size_t)l.cells_x * l.cells_y;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint x = 0; x < l.cells_x; x++) {
        const size_t cell = (size_t)y * l.cells_x + x;
        const float chosen = l.median ? median(&l, cells + CELL_LABEL * plane, x, y) : cells[cell];
        const size_t at = cell * padded + (size_t)(chosen + 0.5f);
        const uint own = 2 * costs[at] + (SV_WALL_OWN_AWAY - 2) * aways[at];
        cells[CELL_CHOSEN * plane + cell] = chosen;
        cells[CELL_OWN * plane + cell] = (float)own / (2 * SV_WALL_CELL_ONE);
    }
}

/* One work item per row of cells: the confidence. Opposite neighbours are added first, so a mirrored map
 * gives the mirrored result. */
__kernel void wall_trust(sv_wall_layout l, __global const uint *restrict info,
                         __global float *restrict cells) {
    const uint y = (uint)get_global_id(0);
    const size_t plane = (size_t)l.cells_x * l.cells_y;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint x = 0; x < l.cells_x; x++) {
        float n[9];
        neighbours(&l, cells + CELL_OWN * plane, x, y, n);
        const float corners = (n[0] + n[8]) + (n[2] + n[6]), edges = (n[1] + n[7]) + (n[3] + n[5]);
        const float own = (corners + 2.0f * edges + 4.0f * n[4]) / 16.0f / l.doubt;
        cells[CELL_LABEL * plane + (size_t)y * l.cells_x + x] = 1.0f / (1.0f + own * own);
    }
}

/* Two cells and their weights. */
typedef struct {
    uint low, high;
    float low_weight, high_weight;
} pair_t;

/* Where a pixel lies between the centres of cells. Both weights are quotients of integers, so that the
 * mirrored pixel has the same. */
static pair_t between(uint i, uint pixels, uint cells) {
    const int at = (int)((2 * i + 1) * cells) - (int)pixels, width = 2 * (int)pixels;
    if (at <= 0) return (pair_t){0, 0, 1.0f, 0.0f};
    const int cell = at / width, rest = at % width;
    if ((uint)cell + 1 >= cells) return (pair_t){cells - 1, cells - 1, 1.0f, 0.0f};
    return (pair_t){(uint)cell, (uint)cell + 1, (float)(width - rest) / (float)width,
                    (float)rest / (float)width};
}

/* The four products are added in an order that neither mirroring nor transposing changes. */
static float interpolate(const sv_wall_layout *l, __global const float *cells, pair_t u, pair_t v) {
    __global const float *top = cells + (size_t)v.low * l->cells_x,
                         *bottom = cells + (size_t)v.high * l->cells_x;
    const float a = u.low_weight * v.low_weight * top[u.low], b = u.high_weight * v.low_weight * top[u.high];
    const float c = u.low_weight * v.high_weight * bottom[u.low];
    const float d = u.high_weight * v.high_weight * bottom[u.high];
    return (a + d) + (b + c);
}

/* One work item per row of pixels. The surface does not depend on q: both ends of its range are the same.
 * Without a surface, zeros. */
__kernel void wall_leave(sv_wall_layout l, __global const uint *restrict info,
                         __global const float *restrict cells, __global float *restrict confidence,
                         uint padded_width, __global float *restrict surfaces) {
    const uint y = (uint)get_global_id(0);
    const size_t plane = (size_t)l.cells_x * l.cells_y;
    const bool wanted = info[INFO_OUTCOME] == SV_WALL_SURFACE;
    const pair_t v = between(y, l.height, l.cells_y);
    __global float *near = surfaces + (size_t)y * padded_width;
    __global float *far = near + (size_t)padded_width * l.height;
    confidence += (size_t)y * l.width;
    for (uint x = 0; x < l.width; x++) {
        const pair_t u = between(x, l.width, l.cells_x);
        const float depth =
            wanted ? (float)l.step * interpolate(&l, cells + CELL_CHOSEN * plane, u, v) : 0.0f;
        near[x] = far[x] = depth;
        confidence[x] = wanted ? interpolate(&l, cells + CELL_LABEL * plane, u, v) : 0.0f;
    }
}
