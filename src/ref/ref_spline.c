/* SPDX-License-Identifier: MIT */
#include "ref/ref_spline.h"

#include "spline/spline_shared.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void swap_rows(double *a, uint32_t n, uint32_t i, uint32_t j) {
    for (uint32_t c = 0; c < n; c++) {
        const double keep = a[(size_t)i * n + c];
        a[(size_t)i * n + c] = a[(size_t)j * n + c];
        a[(size_t)j * n + c] = keep;
    }
}

static double largest_of(const double *a, size_t count) {
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(a[i]));
    return largest;
}

bool sv_ref_factor(double *a, uint32_t n, uint32_t *pivots) {
    const double smallest = largest_of(a, (size_t)n * n) * DBL_EPSILON * n;
    for (uint32_t k = 0; k < n; k++) {
        uint32_t best = k;
        for (uint32_t i = k + 1; i < n; i++)
            if (fabs(a[(size_t)i * n + k]) > fabs(a[(size_t)best * n + k])) best = i;
        pivots[k] = best;
        if (fabs(a[(size_t)best * n + k]) <= smallest) return false;
        if (best != k) swap_rows(a, n, best, k);
        for (uint32_t i = k + 1; i < n; i++) {
            const double factor = a[(size_t)i * n + k] / a[(size_t)k * n + k];
            a[(size_t)i * n + k] = factor;
            for (uint32_t c = k + 1; c < n; c++) a[(size_t)i * n + c] -= factor * a[(size_t)k * n + c];
        }
    }
    return true;
}

void sv_ref_solve(const double *a, uint32_t n, const uint32_t *pivots, double *b) {
    for (uint32_t k = 0; k < n; k++) {
        const double keep = b[k];
        b[k] = b[pivots[k]];
        b[pivots[k]] = keep;
    }
    for (uint32_t i = 1; i < n; i++)
        for (uint32_t c = 0; c < i; c++) b[i] -= a[(size_t)i * n + c] * b[c];
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t c = i + 1; c < n; c++) b[i] -= a[(size_t)i * n + c] * b[c];
        b[i] /= a[(size_t)i * n + i];
    }
}

double sv_ref_phi(double r_squared) {
    return r_squared > 0.0 ? 0.5 * r_squared * log(r_squared) : 0.0;
}

/* Coordinates of the plane: column c of P at (x, y). */
static double plane_term(const sv_ref_spline *s, uint32_t c, double x, double y) {
    const double dx = x - s->mean_x, dy = y - s->mean_y;
    if (c == 0) return 1.0;
    return c == 1 ? s->axis_x * dx + s->axis_y * dy : s->axis_x * dy - s->axis_y * dx;
}

/* Mean, main axis, and how many of the plane's three columns the points determine. */
static void find_plane(sv_ref_spline *s) {
    double xx = 0.0, xy = 0.0, yy = 0.0, along = 0.0, across = 0.0;
    for (uint32_t i = 0; i < s->count; i++) {
        s->mean_x += s->x[i] / s->count;
        s->mean_y += s->y[i] / s->count;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        const double dx = s->x[i] - s->mean_x, dy = s->y[i] - s->mean_y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    const double angle = 0.5 * atan2(2.0 * xy, xx - yy);
    s->axis_x = cos(angle);
    s->axis_y = sin(angle);
    for (uint32_t i = 0; i < s->count; i++) {
        along = fmax(along, fabs(plane_term(s, 1, s->x[i], s->y[i])));
        across = fmax(across, fabs(plane_term(s, 2, s->x[i], s->y[i])));
    }
    s->rank = along == 0.0 ? 1 : across <= 1e-12 * along ? 2 : 3;
}

/* The matrix of Eq. 3.8 with lambda on the diagonal of K (Eq. 3.15). */
static void fill_matrix(const sv_ref_spline *s, double lambda, double *m) {
    const size_t n = s->count, size = n + s->rank;
    memset(m, 0, size * size * sizeof *m);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            const double dx = s->x[i] - s->x[j], dy = s->y[i] - s->y[j];
            m[i * size + j] = sv_ref_phi(dx * dx + dy * dy) + (i == j ? lambda : 0.0);
        }
        for (uint32_t c = 0; c < s->rank; c++)
            m[i * size + n + c] = m[(n + c) * size + i] = plane_term(s, c, s->x[i], s->y[i]);
    }
}

static double spline_at(const sv_ref_spline *s, double x, double y) {
    double sum = 0.0;
    for (uint32_t c = 0; c < s->rank; c++) sum += s->plane[c] * plane_term(s, c, x, y);
    for (uint32_t i = 0; i < s->count; i++) {
        const double dx = x - s->x[i], dy = y - s->y[i];
        sum += s->w[i] * sv_ref_phi(dx * dx + dy * dy);
    }
    return sum;
}

bool sv_ref_spline_solve(const double *x, const double *y, const double *z, uint32_t count, double lambda,
                         sv_ref_spline *out) {
    *out = (sv_ref_spline){.count = count};
    if (count == 0) return true;
    out->x = malloc(3 * (size_t)count * sizeof *out->x);
    if (!out->x) return false;
    out->y = out->x + count;
    out->w = out->y + count;
    memcpy(out->x, x, count * sizeof *x);
    memcpy(out->y, y, count * sizeof *y);
    find_plane(out);
    const uint32_t size = count + out->rank;
    double *m = malloc(((size_t)size + 1) * size * sizeof *m);
    uint32_t *pivots = malloc(size * sizeof *pivots);
    if (m && pivots) {
        double *b = m + (size_t)size * size;
        fill_matrix(out, lambda, m);
        out->singular = !sv_ref_factor(m, size, pivots);
        for (uint32_t i = 0; i < size; i++) b[i] = i < count ? z[i] : 0.0;
        if (!out->singular) sv_ref_solve(m, size, pivots, b);
        memcpy(out->w, b, count * sizeof *b);
        for (uint32_t c = 0; c < out->rank; c++) out->plane[c] = b[count + c];
    }
    const bool ok = m && pivots;
    free(m);
    free(pivots);
    if (!ok) sv_ref_spline_free(out);
    return ok;
}

void sv_ref_spline_free(sv_ref_spline *s) {
    free(s->x);
    s->x = NULL;
}

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
    const double a = spline_at(s, u * step_x, v * step_y);
    const double b = spline_at(s, (u + 1.0) * step_x, v * step_y);
    const double c = spline_at(s, u * step_x, (v + 1.0) * step_y);
    const double d = spline_at(s, (u + 1.0) * step_x, (v + 1.0) * step_y);
    return (1.0 - fy) * ((1.0 - fx) * a + fx * b) + fy * ((1.0 - fx) * c + fx * d);
}

/* Every pixel of a map, or, with cells > 0, bilinear between the nodes of `cells` x `cells` cells. */
static void spline_surface(const sv_ref_spline *s, uint32_t width, uint32_t height, uint32_t cells,
                           double *surface) {
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            surface[(size_t)y * width + x] = s->count == 0 ? 0.0
                                             : cells == 0  ? spline_at(s, x, y)
                                                           : between_nodes(s, width, height, cells, x, y);
}

/* More points than the solver takes are merged, even where no merging was asked for. */
static uint32_t merge_for(const sv_ref_task *task, double *x, double *y, double *z) {
    const uint32_t n = sv_ref_merge(&task->map, task->settings->merge_grid, x, y, z);
    if (task->settings->merge_grid > 0 || n <= SV_SPLINE_MAX_POINTS) return n;
    return sv_ref_merge(&task->map, SV_SPLINE_MAX_GRID, x, y, z);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): the signature is that of all methods */
static bool of_task(const sv_ref_task *task, double *surface) {
    const size_t count = (size_t)task->map.width * task->map.height;
    double *x = malloc(3 * count * sizeof *x), *y = x + count, *z = y + count;
    if (!x) return false;
    sv_ref_spline spline;
    const uint32_t n = merge_for(task, x, y, z);
    const bool ok = sv_ref_spline_solve(x, y, z, n, task->settings->lambda, &spline);
    if (ok) {
        assert(!spline.singular);
        spline_surface(&spline, task->map.width, task->map.height, task->settings->spline_grid, surface);
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

const sv_ref_method sv_ref_method_spline = {.bound = bound, .surface = of_task};
