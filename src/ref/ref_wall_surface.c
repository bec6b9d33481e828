/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The nearest of 0 .. count - 1. */
static size_t inside(int64_t at, size_t count) {
    return at < 0 ? 0 : at >= (int64_t)count ? count - 1 : (size_t)at;
}

/* A weighted sum along one axis; beyond the border the cell at the border counts. */
static void blur_along(const uint32_t *from, uint32_t *to, size_t blocks, size_t count, size_t stride,
                       const uint32_t *weights, uint32_t reach) {
    for (size_t block = 0; block < blocks; block++, from += count * stride)
        for (size_t at = 0; at < count; at++)
            for (size_t i = 0; i < stride; i++) {
                uint32_t sum = weights[0] * from[at * stride + i];
                for (uint32_t k = 1; k <= reach; k++)
                    sum += weights[k] * (from[inside((int64_t)at - k, count) * stride + i] +
                                         from[inside((int64_t)at + k, count) * stride + i]);
                *to++ = sum;
            }
}

/* The lateral Gaussian, rounded half up at its end only: so the order of the axes does not matter. */
static void blur(const sv_wall_layout *l, uint32_t *costs, uint32_t *rows) {
    const size_t all = (size_t)l->cells_x * l->cells_y * l->labels;
    const uint32_t one = SV_WALL_KERNEL_ONE * SV_WALL_KERNEL_ONE;
    blur_along(costs, rows, l->cells_y, l->cells_x, l->labels, l->kernel_x, l->reach_x);
    blur_along(rows, costs, 1, l->cells_y, (size_t)l->cells_x * l->labels, l->kernel_y, l->reach_y);
    for (size_t i = 0; i < all; i++) costs[i] = (costs[i] + one / 2) / one;
}

/* The mean of the labels around the cheapest one that cost at most `slack` more, weighted by what they cost
 * less than that; of several cheapest the one nearest to the viewer counts. In labels. */
static float cheapest(const uint32_t *cost, uint32_t labels, uint32_t slack) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < labels; i++)
        if (cost[i] < cost[best]) best = i;
    const uint32_t limit = cost[best] + slack;
    uint64_t weight = slack, sum = (uint64_t)slack * best;
    for (uint32_t i = best; i > 0 && cost[i - 1] < limit; i--) {
        weight += limit - cost[i - 1];
        sum += (uint64_t)(limit - cost[i - 1]) * (i - 1);
    }
    for (uint32_t i = best + 1; i < labels && cost[i] < limit; i++) {
        weight += limit - cost[i];
        sum += (uint64_t)(limit - cost[i]) * i;
    }
    return weight ? (float)sum / (float)weight : (float)best;
}

static int by_value(const void *a, const void *b) {
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Of a cell and its eight neighbours; beyond the border the cell at the border counts. */
static void neighbours(const float *map, uint32_t columns, uint32_t rows, uint32_t x, uint32_t y,
                       float out[9]) {
    for (int v = -1; v <= 1; v++)
        for (int u = -1; u <= 1; u++)
            *out++ = map[inside((int64_t)y + v, rows) * columns + inside((int64_t)x + u, columns)];
}

static float middle(const float *map, uint32_t columns, uint32_t rows, uint32_t x, uint32_t y) {
    float values[9];
    neighbours(map, columns, rows, x, y, values);
    qsort(values, 9, sizeof *values, by_value);
    return values[4];
}

/* Weights 1 2 1 along both axes. The sum of opposite neighbours comes first, so a mirrored map gives the
 * mirrored result. */
static float smooth(const float *map, uint32_t columns, uint32_t rows, uint32_t x, uint32_t y) {
    float n[9];
    neighbours(map, columns, rows, x, y, n);
    const float corners = (n[0] + n[8]) + (n[2] + n[6]), edges = (n[1] + n[7]) + (n[3] + n[5]);
    return (corners + 2.0f * edges + 4.0f * n[4]) / 16.0f;
}

/* Two cells and their weights. */
typedef struct {
    uint32_t low, high;
    float low_weight, high_weight;
} pair;

/* Where pixel i lies between the centres of cells; beyond the outermost centres their value counts. Both
 * weights are quotients of integers, so that the mirrored pixel has the same. */
static pair between(uint32_t i, uint32_t pixels, uint32_t cells) {
    const int64_t at = (int64_t)(2 * (uint64_t)i + 1) * cells - pixels, width = 2 * (int64_t)pixels;
    if (at <= 0) return (pair){0, 0, 1.0f, 0.0f};
    const uint32_t cell = (uint32_t)(at / width);
    if (cell + 1 >= cells) return (pair){cells - 1, cells - 1, 1.0f, 0.0f};
    const int64_t rest = at % width;
    return (pair){cell, cell + 1, (float)(width - rest) / (float)width, (float)rest / (float)width};
}

/* Bilinear. The four products are added in an order that neither mirroring nor transposing changes. */
static void interpolate(const sv_wall_layout *l, const float *cells, float scale, float *map) {
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++) {
            const pair u = between(x, l->width, l->cells_x), v = between(y, l->height, l->cells_y);
            const float *top = cells + (size_t)v.low * l->cells_x,
                        *bottom = cells + (size_t)v.high * l->cells_x;
            const float a = u.low_weight * v.low_weight * top[u.low],
                        b = u.high_weight * v.low_weight * top[u.high];
            const float c = u.low_weight * v.high_weight * bottom[u.low];
            const float d = u.high_weight * v.high_weight * bottom[u.high];
            *map++ = scale * ((a + d) + (b + c));
        }
}

/* What the cell's own rays say of the depth that its neighbourhood chose. Distance to the fluid counts twice
 * here. */
static float own_cost(const sv_wall_layout *l, const sv_wall_cells *cells, size_t cell, float label) {
    const size_t at = cell * l->labels + (size_t)(label + 0.5f);
    return (float)(SV_WALL_OWN_AWAY * cells->away[at] + 2 * cells->wrong[at]) / (2 * SV_WALL_CELL_ONE);
}

static void finish(const sv_wall_layout *l, const sv_wall_cells *cells, float *labels, float *chosen,
                   float *depth, float *confidence) {
    const uint32_t nx = l->cells_x, ny = l->cells_y;
    for (uint32_t y = 0; y < ny; y++)
        for (uint32_t x = 0; x < nx; x++) {
            const size_t cell = (size_t)y * nx + x;
            chosen[cell] = l->median ? middle(labels, nx, ny, x, y) : labels[cell];
        }
    for (size_t cell = 0; cell < (size_t)nx * ny; cell++)
        labels[cell] = own_cost(l, cells, cell, chosen[cell]);
    interpolate(l, chosen, (float)l->step, depth);
    const float doubt = l->doubt;
    for (uint32_t y = 0; y < ny; y++)
        for (uint32_t x = 0; x < nx; x++) {
            const float own = smooth(labels, nx, ny, x, y) / doubt;
            chosen[(size_t)y * nx + x] = 1.0f / (1.0f + own * own);
        }
    interpolate(l, chosen, 1.0f, confidence);
}

bool sv_wall_cheapest(const sv_wall_layout *l, const sv_wall_cells *cells, float *depth, float *confidence) {
    const size_t count = (size_t)l->cells_x * l->cells_y, all = count * l->labels;
    uint32_t *costs = calloc(all, sizeof *costs), *rows = calloc(all, sizeof *rows);
    float *labels = calloc(count, sizeof *labels), *chosen = calloc(count, sizeof *chosen);
    const bool done = costs && rows && labels && chosen;
    if (done) {
        for (size_t i = 0; i < all; i++) costs[i] = cells->away[i] + cells->wrong[i];
        blur(l, costs, rows);
        for (size_t i = 0; i < count; i++) labels[i] = cheapest(costs + i * l->labels, l->labels, l->slack);
        finish(l, cells, labels, chosen, depth, confidence);
    }
    free(costs);
    free(rows);
    free(labels);
    free(chosen);
    return done;
}
