/* SPDX-License-Identifier: MIT */
/* Cost volume, the surface: the Gaussian along y, the minimum, the median, and the interpolation to pixels.
 * */
#ifndef SV_METHOD_COST_CLH
#include "cost/cost.clh"
#endif

/* Floats of a cell in the map of minima: place and its standard deviation in bins, confidence, 1 if valid. */
#define CELL_FLOATS 4

/* Returns the bins low .. high around `at` that cost less than `edge`. */
static int2 basin(const float *cost, int labels, int at, float edge) {
    int low = at, high = at;
    while (low > 0 && cost[low - 1] < edge) low--;
    while (high + 1 < labels && cost[high + 1] < edge) high++;
    return (int2)(low, high);
}

/* Returns the middle of the lowest minimum, its standard deviation, and its lead over any other one. */
static float4 find_minimum(const float *cell, int labels) {
    const float rays = cell[SV_COST_WEIGHT];
    if (!(rays > 1e-3f)) return (float4)(0.0f);
    float cost[SV_COST_LABELS];
    float lowest = INFINITY, second = INFINITY;
    int at = 0;
    for (int i = 0; i < labels; i++) {
        cost[i] = cell[i] / rays;
        if (cost[i] < lowest) {
            lowest = cost[i];
            at = i;
        }
    }
    const float edge = lowest + SV_COST_AVERAGE_MARGIN;
    const int2 flat = basin(cost, labels, at, edge);
    float weight = 0.0f, first = 0.0f, square = 0.0f;
    for (int i = flat.x; i <= flat.y; i++) {
        const float w = edge - cost[i], d = (float)(i - at);
        weight += w;
        first += w * d;
        square += w * d * d;
    }
    first /= weight;
    const float spread = sqrt(max(square / weight - first * first, 0.0f));
    const int2 wide = basin(cost, labels, at, lowest + SV_COST_MARGIN);
    for (int i = 0; i < labels; i++)
        if (i < wide.x || i > wide.y) second = min(second, cost[i]);
    const float lead = min((second - lowest) / SV_COST_MARGIN, 1.0f);
    const float open = min(cell[SV_COST_OPEN] / rays, 1.0f), known = min(SV_COST_KNOWN * open, 1.0f);
    return (float4)(known * ((float)at + first), known * spread, lead * open, 1.0f);
}

/*
 * Blends the costs per ray with those of the frame before, unless they changed too much (a cut, or something
 * moved through), and keeps them for the next frame.
 */
static void blend_previous(float *cell, int labels, float memory, __global float *previous) {
    const float rays = cell[SV_COST_WEIGHT];
    if (!(rays > 1e-3f)) {
        previous[SV_COST_WEIGHT] = 0.0f;
        return;
    }
    float change = 0.0f;
    for (int i = 0; i < SV_COST_VALUES; i++) cell[i] /= rays;
    for (int i = 0; i < labels; i++) change += fabs(cell[i] - previous[i]);
    const bool keeps = previous[SV_COST_WEIGHT] > 0.0f && change < SV_COST_CHANGE * (float)labels;
    const float share = keeps ? memory : 0.0f;
    for (int i = 0; i < SV_COST_VALUES; i++) {
        if (share > 0.0f) cell[i] += share * (previous[i] - cell[i]);
        previous[i] = cell[i];
    }
}

/* One work item per row of cells: blurs along y, blends with the frame before, and finds the minima. */
__kernel void cost_minimum(sv_cost_layout l, float8 weight, float memory, __global const uint *restrict info,
                           __global float *restrict blurred, __global float *restrict previous,
                           __global float *restrict minima) {
    const int y = (int)get_global_id(0);
    if (!info[SV_COST_INFO_WANTED]) return;
    float weights[8];
    vstore8(weight, 0, weights);
    const int y0 = max(y - SV_COST_REACH, 0), y1 = min(y + SV_COST_REACH, (int)l.cells_y - 1);
    for (uint x = 0; x < l.cells_x; x++) {
        float16 parts[SV_COST_VALUES / SV_LANES];
        float *cell = (float *)parts;
        for (uint v = 0; v < SV_COST_VALUES; v += SV_LANES) {
            float16 sum = (float16)(0.0f);
            for (int w = y0; w <= y1; w++)
                sum += weights[abs(w - y)] * vload16(0, cell_at(blurred, &l, x, (uint)w) + v);
            parts[v / SV_LANES] = sum;
        }
        blend_previous(cell, (int)l.labels, memory, cell_at(previous, &l, x, (uint)y));
        vstore4(find_minimum(cell, (int)l.labels), (size_t)y * l.cells_x + x, minima);
    }
}

/* One work item per row of cells: the median of the valid places of the 3 x 3 neighbourhood (of an even
 * number, the mean of the middle two), moved towards the viewer where the confidence is low. */
__kernel void cost_median(sv_cost_layout l, __global const uint *restrict info,
                          __global const float *restrict minima, __global float *restrict smooth) {
    const int y = (int)get_global_id(0), nx = (int)l.cells_x, ny = (int)l.cells_y;
    if (!info[SV_COST_INFO_WANTED]) return;
    for (int x = 0; x < nx; x++) {
        float4 cell = vload4((size_t)y * l.cells_x + (uint)x, minima);
        float sorted[9];
        int count = 0;
        for (int v = max(y - 1, 0); v <= min(y + 1, ny - 1); v++)
            for (int u = max(x - 1, 0); u <= min(x + 1, nx - 1); u++) {
                const float4 other = vload4((size_t)v * l.cells_x + (uint)u, minima);
                if (other.w == 0.0f) continue;
                int slot = count++;
                for (; slot > 0 && sorted[slot - 1] > other.x; slot--) sorted[slot] = sorted[slot - 1];
                sorted[slot] = other.x;
            }
        if (cell.w != 0.0f) {
            const float middle = 0.5f * (sorted[count / 2] + sorted[(count - 1) / 2]);
            const float shift = SV_COST_VIEWER_SHIFT * l.scale * (1.0f - cell.z);
            /* From here on values are in slices: depth, half the way from q = 0 to q = 1, confidence. */
            cell.x = (middle - shift + 0.5f) * (float)l.bin_slices - 0.5f;
            cell.y *= SV_COST_SPREAD * (float)l.bin_slices;
        }
        vstore4(cell, (size_t)y * l.cells_x + (uint)x, smooth);
    }
}

/* Returns the place of a pixel between the centres of two cells. */
static float cell_place(uint pixel, uint block, uint cells) {
    const float place = ((float)pixel + 0.5f) / (float)block - 0.5f;
    return min(max(place, 0.0f), (float)(cells - 1));
}

/* One work item per row of pixels: interpolates between the cells. Without a surface it stores zeros. */
__kernel void cost_upsample(sv_cost_layout l, uint padded_width, __global const uint *restrict info,
                            __global const float *restrict smooth, __global float *restrict confidence,
                            __global float *restrict surfaces) {
    const uint y = (uint)get_global_id(0);
    const size_t plane = (size_t)padded_width * l.height, row = (size_t)y * padded_width;
    const uint side = l.block * l.shrink; /* of a cell, in pixels */
    const bool wanted = info[SV_COST_INFO_WANTED] != 0;
    const float v = cell_place(y, side, l.cells_y);
    const uint y0 = (uint)v, y1 = min(y0 + 1, l.cells_y - 1);
    const float fv = v - (float)y0;
    for (uint x = 0; x < l.width; x++) {
        float4 at = (float4)(0.0f);
        if (wanted) {
            const float u = cell_place(x, side, l.cells_x);
            const uint x0 = (uint)u, x1 = min(x0 + 1, l.cells_x - 1);
            const float fu = u - (float)x0;
            const float4 top = vload4((size_t)y0 * l.cells_x + x0, smooth) * (1.0f - fu) +
                               vload4((size_t)y0 * l.cells_x + x1, smooth) * fu;
            const float4 bottom = vload4((size_t)y1 * l.cells_x + x0, smooth) * (1.0f - fu) +
                                  vload4((size_t)y1 * l.cells_x + x1, smooth) * fu;
            at = top * (1.0f - fv) + bottom * fv;
        }
        surfaces[row + x] = at.x - at.y;
        surfaces[plane + row + x] = at.x + at.y;
        confidence[(size_t)y * l.width + x] = at.z;
    }
}
