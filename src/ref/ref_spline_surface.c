/* SPDX-License-Identifier: MIT */
/* Around the spline: merging of points (Algorithm 4.2), and the surface from a coarse grid or
 * pixel by pixel. */
#include "ref/ref_spline.h"

#include "spline/spline_shared.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

uint32_t sv_ref_merge(const sv_ref_map *map, uint32_t grid, double *x, double *y, double *z) {
    const uint32_t cells_x = grid ? grid : map->width, cells_y = grid ? grid : map->height;
    uint32_t count = 0;
    for (uint32_t cy = 0; cy < cells_y; cy++)
        for (uint32_t cx = 0; cx < cells_x; cx++) {
            double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_z = 0.0;
            /* pixel (u, v) lies in cell (u * cells / width, v * cells / height) */
            for (uint32_t v = 0; v < map->height; v++) {
                if ((uint64_t)v * cells_y / map->height != cy) continue;
                for (uint32_t u = 0; u < map->width; u++) {
                    const size_t i = (size_t)v * map->width + u;
                    if ((uint64_t)u * cells_x / map->width != cx || !map->status[i]) continue;
                    n += 1.0;
                    sum_x += u;
                    sum_y += v;
                    sum_z += map->depth[i];
                }
            }
            if (n == 0.0) continue;
            x[count] = sum_x / n;
            y[count] = sum_y / n;
            z[count++] = sum_z / n;
        }
    return count;
}

/* Bilinear between the nodes around pixel (x, y); nodes at multiples of (side - 1) / cells. */
static double between_nodes(const sv_ref_spline *s, uint32_t width, uint32_t height, uint32_t cells, double x,
                            double y) {
    const double step_x = (width - 1.0) / cells, step_y = (height - 1.0) / cells;
    const double u = step_x > 0.0 ? fmin(floor(x / step_x), cells - 1.0) : 0.0;
    const double v = step_y > 0.0 ? fmin(floor(y / step_y), cells - 1.0) : 0.0;
    const double fx = step_x > 0.0 ? x / step_x - u : 0.0, fy = step_y > 0.0 ? y / step_y - v : 0.0;
    const double a = sv_ref_spline_at(s, u * step_x, v * step_y);
    const double b = sv_ref_spline_at(s, (u + 1.0) * step_x, v * step_y);
    const double c = sv_ref_spline_at(s, u * step_x, (v + 1.0) * step_y);
    const double d = sv_ref_spline_at(s, (u + 1.0) * step_x, (v + 1.0) * step_y);
    return (1.0 - fy) * ((1.0 - fx) * a + fx * b) + fy * ((1.0 - fx) * c + fx * d);
}

void sv_ref_spline_surface(const sv_ref_spline *s, uint32_t width, uint32_t height, uint32_t cells,
                           double *surface) {
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            surface[(size_t)y * width + x] = s->count == 0 ? 0.0
                                             : cells == 0  ? sv_ref_spline_at(s, x, y)
                                                           : between_nodes(s, width, height, cells, x, y);
}

/* More points than the solver takes are merged, even where no merging was asked for. */
static uint32_t merge_for(const sv_ref_task *task, double *x, double *y, double *z) {
    const uint32_t n = sv_ref_merge(&task->map, task->settings->merge_grid, x, y, z);
    if (task->settings->merge_grid > 0 || n <= SV_SPLINE_MAX_POINTS) return n;
    return sv_ref_merge(&task->map, SV_SPLINE_MAX_GRID, x, y, z);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    (void)either;
    const size_t count = (size_t)task->map.width * task->map.height;
    double *x = malloc(3 * count * sizeof *x), *y = x + count, *z = y + count;
    if (!x) return false;
    sv_ref_spline spline;
    const uint32_t n = merge_for(task, x, y, z);
    const bool ok = sv_ref_spline_solve(x, y, z, n, task->settings->lambda, &spline);
    if (ok) {
        assert(!spline.singular);
        sv_ref_spline_surface(&spline, task->map.width, task->map.height, task->settings->spline_grid,
                              surface);
        sv_ref_spline_free(&spline);
    }
    free(x);
    return ok;
}

/* Float64 solves to far below a thousandth of a slice; float32, with at most 64 points, to a hundredth. */
static double bound(const sv_ref_task *task, const sv_ref_device *device) {
    (void)task;
    return device->doubles ? 1e-3 : 1e-2;
}

const sv_ref_method sv_ref_method_spline = {.bound = bound, .given_up = {0.12, 0.30}, .surface = of_task};
