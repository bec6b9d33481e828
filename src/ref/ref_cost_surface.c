/* SPDX-License-Identifier: MIT */
/* Cost volume: rays gathered into cells, the lateral Gaussian, the minimum, the median, and the way
 * back to pixels. */
#include "ref/ref_cost.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TIE 1e-5 /* costs this close may fall out either way in float32 */

/* Adds up the costs of one cell's rays. */
static void gather_cell(const sv_ref_cost_scan *scan, uint32_t cx, uint32_t cy, double *cell,
                        sv_ref_cost_facts *facts) {
    const sv_ref_cost_layout *l = scan->layout;
    const uint32_t x1 =
        (cx + 1) * l->sizes.block < l->sizes.columns ? (cx + 1) * l->sizes.block : l->sizes.columns;
    const uint32_t y1 = (cy + 1) * l->sizes.block < l->sizes.rows ? (cy + 1) * l->sizes.block : l->sizes.rows;
    for (uint32_t y = cy * l->sizes.block; y < y1; y++)
        for (uint32_t x = cx * l->sizes.block; x < x1; x++) {
            sv_ref_cost_ray ray;
            if (!sv_ref_cost_of_ray(scan, x, y, &ray)) continue;
            for (uint32_t i = 0; i < l->sizes.labels; i++) cell[i] += ray.weight * ray.cost[i];
            cell[SV_COST_WEIGHT] += ray.weight;
            cell[SV_COST_OPEN] += ray.open ? ray.weight : 0.0;
            facts->rays++;
            facts->open += ray.open;
        }
}

/* One pass of the Gaussian, along x (step of one cell) or y; cells outside the image do not count. */
static void blur(const double *from, double *to, const sv_ref_cost_layout *l, bool along_x) {
    double weight[SV_COST_REACH + 1];
    for (int i = 0; i <= SV_COST_REACH; i++) weight[i] = exp(-0.5 * i * i / (l->sigma * l->sigma));
    const int nx = (int)l->sizes.cells_x, ny = (int)l->sizes.cells_y;
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++)
            for (int v = 0; v < SV_COST_VALUES; v++) {
                double sum = 0.0;
                for (int i = -SV_COST_REACH; i <= SV_COST_REACH; i++) {
                    const int u = along_x ? x + i : x, w = along_x ? y : y + i;
                    if (u < 0 || u >= nx || w < 0 || w >= ny) continue;
                    sum += weight[abs(i)] *
                           from[((size_t)w * l->sizes.cells_x + (size_t)u) * SV_COST_VALUES + (size_t)v];
                }
                to[((size_t)y * l->sizes.cells_x + (size_t)x) * SV_COST_VALUES + (size_t)v] = sum;
            }
}

double *sv_ref_cost_volume(const uint8_t *bins, const sv_ref_cost_layout *l, sv_ref_cost_facts *facts) {
    const size_t all = (size_t)l->sizes.columns * l->sizes.rows * l->sizes.labels,
                 cells = (size_t)l->sizes.cells_x * l->sizes.cells_y;
    uint16_t *sums = malloc(2 * all * sizeof *sums);
    uint8_t *walls = malloc(2 * cells);
    double *volume = calloc(cells * SV_COST_VALUES, sizeof *volume);
    double *rows = calloc(cells * SV_COST_VALUES, sizeof *rows);
    sv_ref_cost_scan scan = {.layout = l, .bins = bins, .sums = sums, .wall = walls};
    bool done = false;
    if (sums && walls && volume && rows) {
        scan.nearby = sums + all;
        scan.back = walls + cells;
        scan.levels = sv_ref_cost_levels_of(bins, l);
        if (l->level) scan.levels.fluid = (uint32_t)l->level;
        *facts = (sv_ref_cost_facts){.levels = scan.levels};
        done = sv_ref_cost_brightness(bins, l, sums, sums + all) &&
               sv_ref_cost_walls(bins, l, scan.levels.fluid, walls, walls + cells);
    }
    for (uint32_t y = 0; done && y < l->sizes.cells_y; y++)
        for (uint32_t x = 0; x < l->sizes.cells_x; x++)
            gather_cell(&scan, x, y, volume + ((size_t)y * l->sizes.cells_x + x) * SV_COST_VALUES, facts);
    if (done) {
        blur(volume, rows, l, true);
        blur(rows, volume, l, false);
    } else {
        free(volume);
        volume = NULL;
    }
    free(rows);
    free(walls);
    free(sums);
    return volume;
}

/* The minimum of a cell: its middle and its standard deviation, in bins. */
typedef struct {
    double place, spread, confidence;
    bool valid, tie;
} minimum;

static minimum find_minimum(const double *cell, const sv_ref_cost_layout *l) {
    minimum m = {.valid = cell[SV_COST_WEIGHT] > 1e-3};
    if (!m.valid) return m;
    double cost[SV_COST_LABELS] = {0}, lowest = INFINITY, second = INFINITY;
    int at = 0;
    const int n = (int)l->sizes.labels;
    for (int i = 0; i < n; i++) {
        cost[i] = cell[i] / cell[SV_COST_WEIGHT];
        if (cost[i] < lowest) {
            lowest = cost[i];
            at = i;
        }
    }
    const double edge = lowest + l->average_margin;
    int low = at, high = at;
    while (low > 0 && cost[low - 1] < edge) low--;
    while (high + 1 < n && cost[high + 1] < edge) high++;
    if (low > 0 && fabs(cost[low - 1] - edge) < TIE) m.tie = true;
    if (high + 1 < n && fabs(cost[high + 1] - edge) < TIE) m.tie = true;
    double weight = 0.0, first = 0.0, square = 0.0;
    for (int i = low; i <= high; i++) {
        if (fabs(cost[i] - edge) < TIE) m.tie = true;
        const double w = edge - cost[i], d = i - at;
        weight += w;
        first += w * d;
        square += w * d * d;
    }
    first /= weight;
    const double open = fmin(cell[SV_COST_OPEN] / cell[SV_COST_WEIGHT], 1.0),
                 known = fmin(SV_COST_KNOWN * open, 1.0);
    m.place = known * (at + first);
    m.spread = known * sqrt(fmax(square / weight - first * first, 0.0));
    for (int i = 0; i < n; i++) {
        if ((i < low || i > high) && cost[i] - lowest < TIE) m.tie = true;
    }
    low = high = at; /* what lies outside these ends is another minimum */
    while (low > 0 && cost[low - 1] < lowest + SV_COST_MARGIN) low--;
    while (high + 1 < n && cost[high + 1] < lowest + SV_COST_MARGIN) high++;
    for (int i = 0; i < n; i++)
        if (i < low || i > high) second = fmin(second, cost[i]);
    const double lead = fmin((second - lowest) / SV_COST_MARGIN, 1.0);
    m.confidence = lead * open;
    return m;
}

/* Blends the costs per ray with those of the frame before, unless they changed too much, and keeps them for
 * the next frame. */
static void blend_previous(double *cell, double *previous, const sv_ref_cost_layout *l, bool *tie) {
    const double rays = cell[SV_COST_WEIGHT];
    double change = 0.0;
    if (!(rays > 1e-3)) {
        previous[SV_COST_WEIGHT] = 0.0;
        return;
    }
    for (uint32_t i = 0; i < SV_COST_VALUES; i++) cell[i] /= rays;
    for (uint32_t i = 0; i < l->sizes.labels; i++) change += fabs(cell[i] - previous[i]) / l->sizes.labels;
    *tie = fabs(change - SV_COST_CHANGE) < TIE;
    const bool keeps = previous[SV_COST_WEIGHT] > 0.0 && change < SV_COST_CHANGE;
    for (uint32_t i = 0; i < SV_COST_VALUES; i++) {
        if (keeps) cell[i] += l->memory * (previous[i] - cell[i]);
        previous[i] = cell[i];
    }
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median of the valid cells of the 3 x 3 neighbourhood; of an even number, the mean of the middle
 * two. */
static minimum median(const minimum *cells, const sv_ref_cost_layout *l, int x, int y) {
    const int nx = (int)l->sizes.cells_x, ny = (int)l->sizes.cells_y;
    minimum m = cells[y * nx + x];
    double place[9];
    size_t count = 0;
    for (int v = y - 1; v <= y + 1; v++)
        for (int u = x - 1; u <= x + 1; u++) {
            if (u < 0 || v < 0 || u >= nx || v >= ny || !cells[v * nx + u].valid) continue;
            place[count++] = cells[v * nx + u].place;
            m.tie = m.tie || cells[v * nx + u].tie;
        }
    if (!m.valid) return m;
    qsort(place, count, sizeof *place, ascending);
    if (l->median) m.place = 0.5 * (place[count / 2] + place[(count - 1) / 2]);
    m.place -= l->viewer_shift * (1.0 - m.confidence); /* clips less where the confidence is low */
    return m;
}

/* Bilinear between the centres of the cells; invalid cells are depth 0 with no spread and no confidence. */
static void upsample(const minimum *cells, const sv_ref_cost_layout *l, double *near_surface,
                     double *far_surface, double *confidence, uint8_t *tie) {
    const double side = (double)l->sizes.block * l->sizes.shrink; /* of a cell, in pixels */
    for (uint32_t y = 0; y < l->sizes.height; y++)
        for (uint32_t x = 0; x < l->sizes.width; x++) {
            const double u = fmin(fmax((x + 0.5) / side - 0.5, 0.0), l->sizes.cells_x - 1.0);
            const double v = fmin(fmax((y + 0.5) / side - 0.5, 0.0), l->sizes.cells_y - 1.0);
            const uint32_t x0 = (uint32_t)u, y0 = (uint32_t)v;
            double depth = 0.0, spread = 0.0, sum = 0.0;
            bool tied = false;
            for (uint32_t corner = 0; corner < 4; corner++) {
                const uint32_t i = corner & 1, j = corner >> 1;
                const double weight = (i ? u - x0 : 1.0 - (u - x0)) * (j ? v - y0 : 1.0 - (v - y0));
                if (weight == 0.0) continue;
                const minimum *m = &cells[(size_t)(y0 + j) * l->sizes.cells_x + x0 + i];
                tied = tied || m->tie;
                if (!m->valid) continue;
                depth += weight * ((m->place + 0.5) * l->sizes.bin_slices - 0.5);
                spread += weight * m->spread * SV_COST_SPREAD * l->sizes.bin_slices;
                sum += weight * m->confidence;
            }
            const size_t pixel = (size_t)y * l->sizes.width + x;
            near_surface[pixel] = depth - spread;
            far_surface[pixel] = depth + spread;
            confidence[pixel] = sum;
            if (tie) tie[pixel] = tied;
        }
}

bool sv_ref_cost_surface_with(const sv_ref_volume *volume, const sv_ref_cost_layout *l, double *near_surface,
                              double *far_surface, double *confidence, uint8_t *tie,
                              sv_ref_cost_facts *facts) {
    const size_t cells = (size_t)l->sizes.cells_x * l->sizes.cells_y;
    sv_ref_cost_facts found = {0};
    uint8_t *bins = malloc((size_t)l->sizes.labels * l->sizes.columns * l->sizes.rows);
    minimum *raw = calloc(2 * cells, sizeof *raw), *smooth = raw ? raw + cells : NULL;
    double *costs = NULL;
    if (bins && raw) {
        sv_ref_cost_bins(volume, l, bins);
        costs = sv_ref_cost_volume(bins, l, &found);
    }
    if (costs) {
        for (size_t i = 0; i < cells; i++) {
            bool tie_here = false;
            if (l->previous)
                blend_previous(costs + i * SV_COST_VALUES, l->previous + i * SV_COST_VALUES, l, &tie_here);
            raw[i] = find_minimum(costs + i * SV_COST_VALUES, l);
            raw[i].tie = raw[i].tie || tie_here;
        }
        for (int y = 0; y < (int)l->sizes.cells_y; y++)
            for (int x = 0; x < (int)l->sizes.cells_x; x++)
                smooth[y * (int)l->sizes.cells_x + x] = median(raw, l, x, y);
        upsample(smooth, l, near_surface, far_surface, confidence, tie);
    }
    const bool done = costs != NULL;
    for (size_t i = 0; done && tie && i < (size_t)l->sizes.width * l->sizes.height; i++) found.ties += tie[i];
    if (facts) *facts = found;
    free(costs);
    free(raw);
    free(bins);
    return done;
}

bool sv_ref_cost_surface(const sv_ref_volume *volume, float slice_mm, double *near_surface,
                         double *far_surface, double *confidence, uint8_t *tie, sv_ref_cost_facts *facts) {
    const sv_ref_cost_layout l =
        sv_ref_cost_layout_of(volume->width, volume->height, volume->slices, slice_mm);
    return sv_ref_cost_surface_with(volume, &l, near_surface, far_surface, confidence, tie, facts);
}

/* Writes S(q) between the ends; zeros if too few rays have a fluid interval, for then there is no surface. */
static bool of_task(const sv_ref_task *task, double *surface, uint8_t *either) {
    const size_t count = (size_t)task->map.width * task->map.height;
    double *far_surface = malloc(2 * count * sizeof *far_surface), *confidence = far_surface + count;
    sv_ref_cost_facts facts = {0};
    const bool ok = far_surface && sv_ref_cost_surface(task->volume, (float)task->spacing_mm[2], surface,
                                                       far_surface, confidence, either, &facts);
    const bool wanted = facts.open > 0 && facts.open * SV_COST_EVIDENCE >= facts.rays;
    for (size_t i = 0; ok && i < count; i++)
        surface[i] = wanted ? far_surface[i] + task->q * (surface[i] - far_surface[i]) : 0.0;
    free(far_surface);
    return ok;
}

/* The kernels sum up costs in float32. Where two labels cost nearly the same either is right. */
static double bound(const sv_ref_task *task, const sv_ref_device *device) {
    (void)task;
    return device->doubles ? 1e-3 : 1e-2;
}

const sv_ref_method sv_ref_method_cost = {.takes_volume = true, .bound = bound, .surface = of_task};
