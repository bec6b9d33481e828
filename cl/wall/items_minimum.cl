/* SPDX-License-Identifier: MIT */
/*
 * By work items, from costs to the cheapest layer of every ray: the lateral Gaussian over the costs of cells
 * along y and along x, the costs of rays between cells, the minimum, the mean around it, and how far around
 * it the knob may move the surface. Beyond the border the cell at the border counts.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif
#ifndef SV_WALL_PIXELS_CLH
#include "wall/wall_pixels.clh"
#endif
#ifndef SV_WALL_BETWEEN_CLH
#include "wall/wall_between.clh"
#endif

/* One work item per cell: the Gaussian along y. `sums`: 32 bits for each cell. */
__kernel void wall_items_blur_y(sv_wall_layout l, __global const uint *restrict info,
                                __global const ushort *restrict costs, __global uint *restrict sums) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    uint sum = l.kernel_y[0] * costs[cell_row(&l, z, row) + x];
    for (int k = 1; k <= (int)l.reach_y; k++)
        sum += l.kernel_y[k] * ((uint)costs[cell_row(&l, z, clamped(row, -k, l.cells[1])) + x] +
                                costs[cell_row(&l, z, clamped(row, k, l.cells[1])) + x]);
    sums[cell_row(&l, z, row) + x] = sum;
}

/* One work item per cell: the Gaussian along x, rounded half up. */
__kernel void wall_items_blur_x(sv_wall_layout l, __global const uint *restrict info,
                                __global const uint *restrict sums, __global ushort *restrict fine) {
    const uint x = (uint)get_global_id(0), row = row_of_cell(&l), z = layer_of_cell(&l);
    if (x >= l.cells[0] || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    __global const uint *line = sums + cell_row(&l, z, row);
    uint sum = l.kernel_x[0] * line[x];
    for (int k = 1; k <= (int)l.reach_x; k++)
        sum += l.kernel_x[k] * (line[clamped(x, -k, l.cells[0])] + line[clamped(x, k, l.cells[0])]);
    fine[fine_row(&l, z, row) + x] = (ushort)((sum + FINE / 2) / FINE);
}

/* Finds the cheapest layer; of several equal ones the nearest to the viewer. */
static uint minimum_layer(const costs_t *c, uint *minimum) {
    uint best = 0;
    *minimum = cost_at(c, 0);
    for (uint z = 1; z < c->layers; z++) {
        const uint cost = cost_at(c, z);
        best = cost < *minimum ? z : best;
        *minimum = min(*minimum, cost);
    }
    return best;
}

/* Averages the layers around the cheapest one whose cost is below the limit, weighting each by how far it is
 * below. */
static float mean_around(const costs_t *c, uint best, uint limit) {
    uint weight = 0, sum = 0, cost;
    for (uint z = best + 1; z-- > 0 && (cost = cost_at(c, z)) < limit;) {
        weight += limit - cost;
        sum += (limit - cost) * z;
    }
    for (uint z = best + 1; z < c->layers && (cost = cost_at(c, z)) < limit; z++) {
        weight += limit - cost;
        sum += (limit - cost) * z;
    }
    return weight ? (float)sum / (float)weight : (float)best;
}

/* Returns how far behind `inside` the costs cross the limit, in layers. */
static float crossing(uint inside, uint outside, uint limit) {
    return (float)(limit - inside) / (float)(outside - inside);
}

/* Finds how far around the cheapest layer the costs stay below the limit. */
static float near_end(const costs_t *c, uint best, uint limit) {
    uint z = best;
    while (z > 0 && cost_at(c, z - 1) < limit) z--;
    return z > 0 ? (float)z - crossing(cost_at(c, z), cost_at(c, z - 1), limit) : 0.0f;
}

static float far_end(const costs_t *c, uint best, uint limit) {
    uint z = best;
    while (z + 1 < c->layers && cost_at(c, z + 1) < limit) z++;
    return z + 1 < c->layers ? (float)z + crossing(cost_at(c, z), cost_at(c, z + 1), limit) : (float)z;
}

/* One work item per ray. `planes`: the planes of the layers, of the ends around them, which never pass them,
 * and of what the layers cost. */
__kernel void wall_items_minimum(sv_wall_layout l, __global const uint *restrict info,
                                 __global const ushort *restrict fine, __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), row = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const costs_t c = costs_of(&l, fine, x, row);
    uint minimum;
    const uint best = minimum_layer(&c, &minimum);
    const float mean = mean_around(&c, best, minimum + l.average_margin);
    planes[plane_row(&l, PLANE_LAYER, row) + x] = mean;
    planes[plane_row(&l, PLANE_COST, row) + x] = (float)minimum / SV_WALL_FINE_COST_ONE;
    planes[plane_row(&l, PLANE_NEAR, row) + x] = fmin(near_end(&c, best, minimum + l.knob_margin), mean);
    planes[plane_row(&l, PLANE_FAR, row) + x] = fmax(far_end(&c, best, minimum + l.knob_margin), mean);
}
