/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <stdlib.h>

/* The square root of a level in units of 1 / SV_WALL_LEVEL_ONE, linear between whole levels. */
static uint32_t root_of(const uint32_t *root, uint32_t level) {
    const uint32_t whole = level / SV_WALL_LEVEL_ONE, part = level % SV_WALL_LEVEL_ONE;
    if (whole >= 255) return root[255];
    return root[whole] + (root[whole + 1] - root[whole]) * part / SV_WALL_LEVEL_ONE;
}

/* For each brightness around a block, in units of 1 / SV_WALL_BRIGHT_ONE, what its level is multiplied by:
 * SV_WALL_TISSUE over the threshold there, with SV_WALL_GAIN_BITS of fraction. The threshold's root is
 * `threshold` of the way from the dark level's to the brightness'. */
static void find_gains(const sv_wall_layout *l, const sv_wall_levels *levels, uint32_t gains[SV_WALL_GAINS]) {
    uint32_t tables[SV_WALL_TABLE_WORDS];
    const uint32_t *const root = tables + SV_WALL_ROOTS;
    sv_wall_tables(tables);
    const uint32_t one = SV_WALL_PER_MILLE, dark = root_of(root, levels->dark);
    for (uint32_t i = 0; i < SV_WALL_GAINS; i++) {
        const uint32_t bright = root_of(root, i * (SV_WALL_LEVEL_ONE / SV_WALL_BRIGHT_ONE));
        const uint32_t threshold = ((one - l->threshold) * dark + l->threshold * bright) / one;
        gains[i] = ((uint32_t)SV_WALL_TISSUE << (2 * SV_WALL_ROOT_BITS + SV_WALL_GAIN_BITS)) /
                   (threshold * threshold);
    }
}

/* The sum and the number of the bright blocks of every cell. */
typedef struct {
    uint32_t sum, count;
} bright_blocks;

static bright_blocks add(bright_blocks a, bright_blocks b) {
    return (bright_blocks){a.sum + b.sum, a.count + b.count};
}

/* Sums over a window along one axis: `groups` lines of `count` values that lie `stride` apart. Beyond the
 * border there is nothing. */
static void sum_along(const bright_blocks *from, bright_blocks *to, size_t groups, size_t count,
                      size_t stride, size_t reach) {
    for (size_t group = 0; group < groups; group++, from += count * stride)
        for (size_t at = 0; at < count; at++)
            for (size_t i = 0; i < stride; i++) {
                bright_blocks sum = {0, 0};
                for (size_t k = at < reach ? 0 : at - reach; k <= at + reach && k < count; k++)
                    sum = add(sum, from[k * stride + i]);
                *to++ = sum;
            }
}

static void find_bright(const sv_wall_layout *l, const sv_wall_blocks *b, uint32_t threshold,
                        bright_blocks *cells) {
    for (size_t z = 0; z < l->layers; z++)
        for (size_t y = 0; y < l->rows; y++)
            for (size_t x = 0; x < l->columns; x++) {
                const uint32_t level = b->levels[(z * l->rows + y) * l->columns + x];
                const size_t cell = (z * l->cells[1] + y / 2) * l->cells[0] + x / 2;
                if (level > threshold) cells[cell] = add(cells[cell], (bright_blocks){level, 1});
            }
}

/* Returns the mean of the bright blocks around a cell, in units of 1 / SV_WALL_BRIGHT_ONE, but not less than
 * the threshold of the whole scan. The mean of all bright blocks stands in where there are few. */
static uint32_t brightness_around(const sv_wall_layout *l, const sv_wall_levels *levels,
                                  bright_blocks around) {
    const uint32_t all = l->bright_blocks * levels->bright / (SV_WALL_LEVEL_ONE / SV_WALL_BRIGHT_ONE);
    const uint32_t mean = (around.sum * SV_WALL_BRIGHT_ONE + all) / (around.count + l->bright_blocks);
    const uint32_t least = levels->threshold * SV_WALL_BRIGHT_ONE;
    return mean > least ? mean : least;
}

bool sv_wall_relate_levels(const sv_wall_layout *l, const sv_wall_levels *levels, sv_wall_blocks *b) {
    const size_t cells = (size_t)l->cells[0] * l->cells[1], plane = (size_t)l->columns * l->rows;
    bright_blocks *const one = calloc(cells * l->layers, sizeof *one), *const other = calloc(
                                                                           cells * l->layers, sizeof *other);
    uint32_t gains[SV_WALL_GAINS];
    const bool made = one && other;
    if (made) {
        find_gains(l, levels, gains);
        find_bright(l, b, levels->threshold, one);
        sum_along(one, other, l->layers * (size_t)l->cells[1], l->cells[0], 1, l->window[0]);
        sum_along(other, one, l->layers, l->cells[1], l->cells[0], l->window[1]);
        sum_along(one, other, 1, l->layers, cells, l->window[2]);
        for (size_t i = 0; i < plane * l->layers; i++) {
            const size_t x = i % l->columns, y = i / l->columns % l->rows, z = i / plane;
            const bright_blocks around = other[(z * l->cells[1] + y / 2) * l->cells[0] + x / 2];
            const uint32_t level = b->levels[i] * gains[brightness_around(l, levels, around)];
            const uint32_t relative = level >> SV_WALL_GAIN_BITS;
            b->relative[i] = (uint8_t)(relative < 255 ? relative : 255);
        }
    }
    free(one);
    free(other);
    return made;
}

/* Returns the number of dark layers at the start of a ray's scan if they may be the near field, else 0. */
static uint32_t dark_front(const sv_wall_layout *l, const sv_wall_blocks *b, size_t ray) {
    const size_t plane = (size_t)l->columns * l->rows;
    const uint32_t first = b->first[ray], end = b->end[ray];
    uint32_t z = first;
    while (z < end && b->relative[z * plane + ray] <= l->dim) z++;
    return z < end && z - first <= l->near_field ? z - first : 0;
}

void sv_wall_skip_near_field(const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    uint64_t dark = 0;
    for (size_t ray = 0; ray < plane; ray++) dark += dark_front(l, b, ray) > 0;
    if (SV_WALL_NEAR_FIELD * dark < b->rays) return;
    for (size_t ray = 0; ray < plane; ray++)
        b->first[ray] = (uint16_t)(b->first[ray] + dark_front(l, b, ray));
}

uint8_t *sv_wall_near_field_of(const sv_wall_layout *l, const sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    uint8_t *const skipped = calloc(plane, l->layers);
    for (size_t ray = 0; skipped && ray < plane; ray++)
        for (size_t z = 0; z < b->first[ray]; z++) skipped[z * plane + ray] = b->levels[z * plane + ray] > 0;
    return skipped;
}

bool sv_wall_skip_told_field(const sv_wall_told *told, const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows, cells = (size_t)l->cells[0] * l->cells[1];
    if (!told->near_field) return true;
    uint8_t *const marks = calloc(cells, l->layers);
    if (!marks) return false;
    sv_wall_mark_cells(told, told->near_field, l, marks);
    for (size_t ray = 0; ray < plane; ray++) {
        const size_t cell = ray / l->columns / 2 * l->cells[0] + ray % l->columns / 2;
        uint32_t z = b->first[ray];
        while (z < b->end[ray] && b->relative[z * plane + ray] <= l->dim && marks[z * cells + cell]) z++;
        if (z < b->end[ray]) b->first[ray] = (uint16_t)z;
    }
    free(marks);
    return true;
}

void sv_wall_fill_dim_fronts(const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    for (size_t ray = 0; ray < plane; ray++)
        for (size_t z = b->first[ray]; z < b->end[ray]; z++) {
            uint8_t *const relative = &b->relative[z * plane + ray];
            if (*relative <= l->dim || *relative > SV_WALL_TISSUE) break;
            *relative = SV_WALL_DIM_TISSUE;
        }
}
