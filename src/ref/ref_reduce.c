/* SPDX-License-Identifier: MIT */
/*
 * Reconstruction at a reduced resolution (docs/algorithm.md): a cell of r x r pixels becomes one pixel of a
 * smaller map, a method works on that, and its surface is read bilinearly between the cells' centres. Cells
 * at the right and lower border may hold fewer pixels; their centre stays where a whole cell's is.
 */
#include "ref/ref_reduce.h"

#include "quantise.h"

#include <math.h>
#include <stdlib.h>

/* The points of cell (u, v). */
static void merge_cell(const sv_ref_map *map, uint32_t reduction, bool minimum, uint32_t u, uint32_t v,
                       sv_ref_reduced *out) {
    double count = 0.0, sum = 0.0, smallest = INFINITY;
    for (uint32_t y = v * reduction; y < (v + 1) * reduction && y < map->height; y++)
        for (uint32_t x = u * reduction; x < (u + 1) * reduction && x < map->width; x++) {
            const size_t i = (size_t)y * map->width + x;
            if (!map->status[i]) continue;
            count += 1.0;
            sum += map->depth[i];
            smallest = fmin(smallest, map->depth[i]);
        }
    const size_t i = (size_t)v * out->map.width + u;
    out->status[i] = count > 0.0;
    if (count > 0.0) out->depth[i] = minimum ? smallest : sum / count;
}

bool sv_ref_reduce(const sv_ref_map *map, uint32_t reduction, bool minimum, sv_ref_reduced *out) {
    const uint32_t width = sv_reduced_side(map->width, reduction);
    const uint32_t height = sv_reduced_side(map->height, reduction);
    const size_t count = (size_t)width * height;
    *out = (sv_ref_reduced){.status = calloc(count, 1), .depth = calloc(count, sizeof *out->depth)};
    if (!out->status || !out->depth) {
        sv_ref_reduced_free(out);
        return false;
    }
    out->map = (sv_ref_map){out->status, out->depth, width, height};
    for (uint32_t v = 0; v < height; v++)
        for (uint32_t u = 0; u < width; u++) merge_cell(map, reduction, minimum, u, v, out);
    return true;
}

void sv_ref_reduced_free(sv_ref_reduced *reduced) {
    free(reduced->status);
    free(reduced->depth);
    *reduced = (sv_ref_reduced){.status = NULL};
}

/* The two cells around pixel x, and the share of the second. */
static double between(uint32_t x, uint32_t cells, uint32_t reduction, uint32_t *first, uint32_t *second) {
    const double at = fmin(fmax((x - 0.5 * (reduction - 1.0)) / reduction, 0.0), cells - 1.0);
    *first = (uint32_t)at;
    *second = *first + 1 < cells ? *first + 1 : *first;
    return at - *first;
}

void sv_ref_spread(const double *cells, uint32_t width, uint32_t height, uint32_t reduction,
                   double *surface) {
    const uint32_t across = sv_reduced_side(width, reduction);
    const uint32_t down = sv_reduced_side(height, reduction);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint32_t u0, u1, v0, v1;
            const double fx = between(x, across, reduction, &u0, &u1);
            const double fy = between(y, down, reduction, &v0, &v1);
            const double *above = cells + (size_t)v0 * across, *below = cells + (size_t)v1 * across;
            surface[(size_t)y * width + x] = (1.0 - fy) * ((1.0 - fx) * above[u0] + fx * above[u1]) +
                                             fy * ((1.0 - fx) * below[u0] + fx * below[u1]);
        }
}
