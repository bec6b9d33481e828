/* SPDX-License-Identifier: MIT */
#include "loop/map_at.h"

#include <math.h>
#include <stddef.h>

double hs_map_at(const float *map, uint32_t width, uint32_t height, double column, double row) {
    const double x = fmin(fmax(column, 0.0), width - 1.0), y = fmin(fmax(row, 0.0), height - 1.0);
    const uint32_t x0 = (uint32_t)x, y0 = (uint32_t)y;
    const uint32_t x1 = x0 + 1 < width ? x0 + 1 : x0, y1 = y0 + 1 < height ? y0 + 1 : y0;
    const float *top = map + (size_t)y0 * width, *low = map + (size_t)y1 * width;
    const double fx = x - x0, fy = y - y0;
    const double a = (double)top[x0] + fx * ((double)top[x1] - (double)top[x0]);
    const double b = (double)low[x0] + fx * ((double)low[x1] - (double)low[x0]);
    return a + fy * (b - a);
}
