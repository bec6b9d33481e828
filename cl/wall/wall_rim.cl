/* SPDX-License-Identifier: MIT */
/* In both layouts: the pyramid that tells where the surface goes on to. */
#ifndef SV_WALL_RIM_CLH
#include "wall/wall_rim.clh"
#endif

/* Tells a cell of half as wide a grid the mean of those of a grid of `n` that it covers. Where the number of
 * cells is odd, the cells overlap, so that a mirrored grid is told the same. */
static uint4 mean_of_grid(__global const uint4 *fine, uint2 n, uint x, uint y) {
    uint4 sum = (uint4)(0);
    for (uint v = 2 * y - (y > 0 && n.y % 2); v < min(2 * y + 2, n.y); v++)
        for (uint u = 2 * x - (x > 0 && n.x % 2); u < min(2 * x + 2, n.x); u++) {
            uint4 cell = fine[(size_t)v * n.x + u];
            cell.w = cell.w > 0;
            sum += cell;
        }
    return mean_of_sum(sum, 1);
}

/* A grid of the pyramid: where it begins, and its cells across and down. */
typedef struct {
    size_t at;
    uint2 n;
} rim_grid_t;

static rim_grid_t next_grid(rim_grid_t g) {
    return (rim_grid_t){g.at + (size_t)g.n.x * g.n.y, half_of(g.n)};
}

static rim_grid_t grid_of(const sv_wall_layout *l, uint level) {
    rim_grid_t g = {0, (uint2)(l->cells[0], l->cells[1])};
    for (uint i = 0; i < level; i++) g = next_grid(g);
    return g;
}

/* Launched as one work group, or one work item: what is known of cells goes up to coarser grids, and then
 * down to cells of which nothing is known. */
__kernel void wall_rim(sv_wall_layout l, __global const uint *restrict info, __global uint4 *restrict rim) {
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    rim_grid_t g = grid_of(&l, 0);
    uint level = 0;
    for (; g.n.x > 1 || g.n.y > 1; level++) {
        const rim_grid_t next = next_grid(g);
        for (uint i = item; i < next.n.x * next.n.y; i += items)
            rim[next.at + i] = mean_of_grid(rim + g.at, g.n, i % next.n.x, i / next.n.x);
        barrier(CLK_GLOBAL_MEM_FENCE);
        g = next;
    }
    while (level-- > 0) {
        g = grid_of(&l, level);
        for (uint i = item; i < g.n.x * g.n.y; i += items)
            if (!rim[g.at + i].w) rim[g.at + i] = told_by(rim + next_grid(g).at, g.n, i % g.n.x, i / g.n.x);
        barrier(CLK_GLOBAL_MEM_FENCE);
    }
}
