/* SPDX-License-Identifier: MIT */
/* Cost volume: sizes, bins of a ray, grey levels, brightness, and where wall and back of the sac lie. */
#include "ref/ref_cost.h"

#include <math.h>
#include <stdlib.h>

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

sv_ref_cost_layout sv_ref_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices, float slice_mm) {
    sv_ref_cost_layout l = {.sizes = sv_cost_layout_of(width, height, slices, slice_mm)};
    const double scale = (double)l.sizes.scale;
    l.sigma = sv_cost_sigma(&l.sizes);
    l.thick_from = SV_COST_THICK_FROM * scale;
    l.thick_full = SV_COST_THICK_FULL * scale;
    l.tau = SV_COST_TAU * scale;
    l.cut_cost = SV_COST_CUT;
    l.occluder_cost = SV_COST_OCCLUDER;
    l.wrong_fluid_cost = SV_COST_WRONG_FLUID;
    l.thick = SV_COST_THICK;
    l.behind_penalty = SV_COST_BEHIND_PENALTY;
    l.average_margin = SV_COST_AVERAGE_MARGIN;
    l.viewer_shift = SV_COST_VIEWER_SHIFT * scale;
    l.bone_splits = l.median = true;
    return l;
}

static uint8_t bin_mean(const sv_ref_volume *v, const sv_ref_cost_layout *l, uint32_t column, uint32_t row,
                        uint32_t bin) {
    uint32_t sum = 0, count = 0;
    for (uint32_t z = bin * l->sizes.bin_slices; z < (bin + 1) * l->sizes.bin_slices && z < v->slices; z++)
        for (uint32_t y = row * l->sizes.shrink; y < (row + 1) * l->sizes.shrink && y < v->height; y++)
            for (uint32_t x = column * l->sizes.shrink; x < (column + 1) * l->sizes.shrink && x < v->width;
                 x++) {
                const size_t pixel = (size_t)y * v->width + x;
                if (!sv_ref_scanned(v, pixel, z)) continue;
                const uint32_t voxel = v->voxels[(size_t)z * v->width * v->height + pixel];
                sum += voxel;
                count++;
            }
    const uint32_t mean = count ? (sum + count / 2) / count : 0;
    return (uint8_t)(count && mean == 0 ? 1 : mean);
}

void sv_ref_cost_bins(const sv_ref_volume *v, const sv_ref_cost_layout *l, uint8_t *bins) {
    for (uint32_t bin = 0; bin < l->sizes.labels; bin++)
        for (uint32_t row = 0; row < l->sizes.rows; row++)
            for (uint32_t column = 0; column < l->sizes.columns; column++)
                *bins++ = bin_mean(v, l, column, row, bin);
}

sv_ref_cost_levels sv_ref_cost_levels_of(const uint8_t *bins, const sv_ref_cost_layout *l) {
    const size_t plane = (size_t)l->sizes.columns * l->sizes.rows;
    uint64_t histogram[256] = {0}, all = 0, total = 0;
    for (uint32_t cell = 0; cell < l->sizes.cells_y; cell++) {
        const uint32_t middle = cell * l->sizes.block + l->sizes.block / 2;
        const size_t y = middle < l->sizes.rows ? middle : l->sizes.rows - 1;
        for (uint32_t bin = 0; bin < l->sizes.labels; bin++)
            for (uint32_t x = 0; x < l->sizes.columns; x++)
                histogram[bins[bin * plane + y * l->sizes.columns + x]]++;
    }
    for (uint32_t i = 1; i < 256; i++) {
        all += histogram[i];
        total += i * histogram[i];
    }
    uint64_t threshold = all ? total / all : 0, dark = 0, bright = 0;
    for (uint32_t turn = 0; turn < 32; turn++) {
        uint64_t count = 0, sum = 0;
        for (uint32_t i = 1; i <= threshold; i++) {
            count += histogram[i];
            sum += i * histogram[i];
        }
        dark = count ? sum / count : 0;
        bright = all > count ? (total - sum) / (all - count) : threshold;
        const uint64_t next = (dark + bright) / 2;
        if (next == threshold) break;
        threshold = next;
    }
    if (bright < 2 * dark) return (sv_ref_cost_levels){.fluid = 0, .bright = larger((uint32_t)bright, 1)};
    const uint32_t level = (uint32_t)(dark + (bright - dark) / 6);
    return (sv_ref_cost_levels){.fluid = larger(level, 1), .bright = larger((uint32_t)bright, 1)};
}

/* Box filter or dilation along one axis, `reach` neighbours to either side: `blocks` lines of `count` bins
 * that lie `stride` apart. */
static void filter_along(const uint16_t *from, uint16_t *to, size_t blocks, size_t count, size_t stride,
                         size_t reach, bool sums) {
    for (size_t block = 0; block < blocks; block++, from += count * stride)
        for (size_t at = 0; at < count; at++) {
            const size_t first = at < reach ? 0 : at - reach;
            for (size_t i = 0; i < stride; i++) {
                uint32_t value = 0;
                for (size_t k = first; k <= at + reach && k < count; k++) {
                    const uint16_t neighbour = from[k * stride + i];
                    value = sums ? value + neighbour : larger(value, neighbour);
                }
                *to++ = (uint16_t)value;
            }
        }
}

bool sv_ref_cost_brightness(const uint8_t *bins, const sv_ref_cost_layout *l, uint16_t *sums,
                            uint16_t *nearby) {
    const size_t plane = (size_t)l->sizes.columns * l->sizes.rows,
                 rows = (size_t)l->sizes.rows * l->sizes.labels, all = plane * l->sizes.labels;
    uint16_t *a = calloc(all, sizeof *a), *b = calloc(all, sizeof *b);
    if (a && b) {
        for (size_t i = 0; i < all; i++) a[i] = bins[i];
        filter_along(a, b, rows, l->sizes.columns, 1, 1, true);
        filter_along(b, a, l->sizes.labels, l->sizes.rows, l->sizes.columns, 1, true);
        filter_along(a, sums, 1, l->sizes.labels, plane, 1, true);
        filter_along(sums, a, rows, l->sizes.columns, 1, l->sizes.lateral, false);
        filter_along(a, b, l->sizes.labels, l->sizes.rows, l->sizes.columns, l->sizes.lateral, false);
        filter_along(b, nearby, 1, l->sizes.labels, plane, l->sizes.axial, false);
    }
    const bool done = a && b;
    free(a);
    free(b);
    return done;
}

/* Finds the wall and the back of one cell by its own rays; labels and 0 if it has none. A bin is mostly fluid
 * if at least half of the cell's scanned rays are fluid there. */
static void find_own_walls(const uint8_t *bins, const sv_ref_cost_layout *l, uint32_t level, uint32_t cx,
                           uint32_t cy, uint8_t *wall, uint8_t *back) {
    const uint32_t y1 = (cy + 1) * l->sizes.block < l->sizes.rows ? (cy + 1) * l->sizes.block : l->sizes.rows;
    const uint32_t x1 =
        (cx + 1) * l->sizes.block < l->sizes.columns ? (cx + 1) * l->sizes.block : l->sizes.columns;
    bool behind_tissue = false;
    uint32_t run = 0;
    *wall = (uint8_t)l->sizes.labels;
    *back = 0;
    for (uint32_t bin = 0; bin < l->sizes.labels; bin++) {
        uint32_t fluid = 0, scanned = 0;
        for (uint32_t y = cy * l->sizes.block; y < y1; y++)
            for (uint32_t x = cx * l->sizes.block; x < x1; x++) {
                const uint8_t v = bins[((size_t)bin * l->sizes.rows + y) * l->sizes.columns + x];
                scanned += v > 0;
                fluid += v > 0 && v <= level;
            }
        if (scanned && 2 * fluid >= scanned) {
            run += behind_tissue;
            if (run == l->sizes.solid && *wall == l->sizes.labels) *wall = (uint8_t)(bin + 1 - run);
        } else {
            if (scanned && *wall < l->sizes.labels && run >= l->sizes.solid) *back = (uint8_t)bin;
            behind_tissue = behind_tissue || scanned;
            run = 0;
        }
    }
}

static int by_value(const void *a, const void *b) {
    return (int)*(const uint8_t *)a - (int)*(const uint8_t *)b;
}

/* Rank filter: of the values of the cells around (x, y) but `none`, returns the one with `rank` tenths of the
 * others below it. */
static uint8_t rank_filter(const uint8_t *own, const sv_ref_cost_layout *l, int x, int y, uint8_t none,
                           uint32_t rank, uint8_t otherwise) {
    uint8_t values[(2 * SV_COST_WINDOW + 1) * (2 * SV_COST_WINDOW + 1)];
    size_t count = 0;
    for (int v = y - SV_COST_WINDOW; v <= y + SV_COST_WINDOW; v++)
        for (int u = x - SV_COST_WINDOW; u <= x + SV_COST_WINDOW; u++) {
            if (u < 0 || v < 0 || u >= (int)l->sizes.cells_x || v >= (int)l->sizes.cells_y) continue;
            const uint8_t value = own[(size_t)v * l->sizes.cells_x + (size_t)u];
            if (value != none) values[count++] = value;
        }
    if (count == 0) return otherwise;
    qsort(values, count, 1, by_value);
    return values[(count - 1) * rank / 10];
}

bool sv_ref_cost_walls(const uint8_t *bins, const sv_ref_cost_layout *l, uint32_t level, uint8_t *wall,
                       uint8_t *back) {
    const size_t cells = (size_t)l->sizes.cells_x * l->sizes.cells_y;
    const uint8_t none = (uint8_t)l->sizes.labels;
    uint8_t *own = calloc(2 * cells, 1);
    if (!own) return false;
    for (uint32_t y = 0; y < l->sizes.cells_y; y++)
        for (uint32_t x = 0; x < l->sizes.cells_x; x++) {
            const size_t cell = (size_t)y * l->sizes.cells_x + x;
            find_own_walls(bins, l, level, x, y, own + cell, own + cells + cell);
        }
    for (int y = 0; y < (int)l->sizes.cells_y; y++)
        for (int x = 0; x < (int)l->sizes.cells_x; x++) {
            *wall++ = rank_filter(own, l, x, y, none, 2, 0);
            *back++ = rank_filter(own + cells, l, x, y, 0, 1, none);
        }
    free(own);
    return true;
}
