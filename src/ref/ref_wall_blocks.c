/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_blocks.h"

#include <stdlib.h>

/* What voxel `i` of a span weighs. */
static uint32_t weight_of(const sv_wall_span *s, uint32_t i) {
    const bool shared = (i == 0 && s->shares_first) || (i + 1 == s->count && s->shares_last);
    return shared ? 1 : 2;
}

/* The layers at which all voxels of a ray of blocks were scanned. */
static void find_range(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_span *sx,
                       const sv_wall_span *sy, uint16_t *first, uint16_t *end) {
    uint32_t from = 0, to = l->slices;
    for (uint32_t y = sy->first; y < sy->first + sy->count; y++)
        for (uint32_t x = sx->first; x < sx->first + sx->count; x++) {
            const size_t pixel = (size_t)y * l->width + x;
            if (sv_wall_first(v, pixel) > from) from = sv_wall_first(v, pixel);
            if (sv_wall_end(v, pixel) < to) to = sv_wall_end(v, pixel);
        }
    from = (from + l->depth - 1) / l->depth;
    to = to == l->slices ? l->layers : to / l->depth; /* the last layer may have less slices */
    *first = (uint16_t)(from < to ? from : 0);
    *end = (uint16_t)(from < to ? to : 0);
}

static uint8_t mean_of(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_span *sx,
                       const sv_wall_span *sy, uint32_t layer) {
    const uint32_t from = layer * l->depth;
    const uint32_t to = from + l->depth < l->slices ? from + l->depth : l->slices;
    uint32_t sum = 0;
    for (uint32_t z = from; z < to; z++)
        for (uint32_t j = 0; j < sy->count; j++)
            for (uint32_t i = 0; i < sx->count; i++) {
                const size_t row = (size_t)z * l->height + sy->first + j;
                sum += weight_of(sx, i) * weight_of(sy, j) * v->voxels[row * l->width + sx->first + i];
            }
    const uint32_t weight = sx->weight * sy->weight * (to - from);
    return (uint8_t)((sum + weight / 2) / weight);
}

/* The mean `step` blocks along an axis from a block at `at`; `own` if that was not scanned. */
static uint32_t mean_beside(const sv_wall_blocks *b, const uint32_t at[3], int axis, int step, uint32_t own) {
    const uint32_t count[3] = {b->columns, b->rows, b->layers};
    uint32_t to[3] = {at[0], at[1], at[2]};
    if (step < 0 ? at[axis] == 0 : at[axis] + 1 == count[axis]) return own;
    to[axis] = step < 0 ? at[axis] - 1 : at[axis] + 1;
    const size_t ray = (size_t)to[1] * b->columns + to[0];
    const bool scanned = to[2] >= b->first[ray] && to[2] < b->end[ray];
    return scanned ? b->means[(size_t)to[2] * b->columns * b->rows + ray] : own;
}

/* A block of one voxel is all speckle: a dark one would part the wall, a bright one behind it would be the
 * fetus. So its neighbours weigh 1 / SV_WALL_STEADY each. */
static void steady(const sv_wall_layout *l, const sv_wall_blocks *b) {
    const size_t plane = (size_t)b->columns * b->rows;
    uint32_t at[3];
    for (at[1] = 0; at[1] < b->rows; at[1]++)
        for (at[0] = 0; at[0] < b->columns; at[0]++) {
            const size_t ray = (size_t)at[1] * b->columns + at[0];
            for (at[2] = b->first[ray]; at[2] < b->end[ray]; at[2]++) {
                const uint32_t own = b->means[at[2] * plane + ray];
                uint32_t sum = SV_WALL_STEADY * own;
                for (int axis = 0; axis < 3; axis++)
                    if (l->single[axis])
                        sum = sum + mean_beside(b, at, axis, -1, own) + mean_beside(b, at, axis, 1, own) -
                              2 * own;
                b->levels[at[2] * plane + ray] = (uint8_t)((sum + SV_WALL_STEADY / 2) / SV_WALL_STEADY);
            }
        }
}

bool sv_wall_blocks_create(const sv_wall_volume *v, const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    *b = (sv_wall_blocks){.columns = l->columns,
                          .rows = l->rows,
                          .layers = l->layers,
                          .means = calloc(plane, l->layers),
                          .levels = calloc(plane, l->layers),
                          .first = calloc(plane, sizeof(uint16_t)),
                          .end = calloc(plane, sizeof(uint16_t))};
    if (!b->means || !b->levels || !b->first || !b->end) {
        sv_wall_blocks_destroy(b);
        return false;
    }
    for (uint32_t y = 0; y < l->rows; y++)
        for (uint32_t x = 0; x < l->columns; x++) {
            const sv_wall_span sx = sv_wall_span_of(x, l->width, l->columns),
                               sy = sv_wall_span_of(y, l->height, l->rows);
            const size_t ray = (size_t)y * l->columns + x;
            find_range(v, l, &sx, &sy, &b->first[ray], &b->end[ray]);
            b->rays += b->first[ray] < b->end[ray];
            for (uint32_t z = b->first[ray]; z < b->end[ray]; z++)
                b->means[z * plane + ray] = mean_of(v, l, &sx, &sy, z);
        }
    steady(l, b);
    return true;
}

void sv_wall_blocks_destroy(sv_wall_blocks *b) {
    free(b->means);
    free(b->levels);
    free(b->first);
    free(b->end);
    *b = (sv_wall_blocks){0};
}

static uint8_t largest_of(const uint8_t *from, size_t stride, size_t count) {
    uint8_t most = 0;
    for (size_t k = 0; k < count; k++)
        if (from[k * stride] > most) most = from[k * stride];
    return most;
}

static void largest_along(const uint8_t *from, uint8_t *to, size_t groups, size_t count, size_t stride,
                          size_t reach) {
    for (size_t group = 0; group < groups; group++, from += count * stride)
        for (size_t at = 0; at < count; at++) {
            const size_t low = at < reach ? 0 : at - reach,
                         high = at + reach < count ? at + reach : count - 1;
            for (size_t i = 0; i < stride; i++)
                *to++ = largest_of(from + low * stride + i, stride, high - low + 1);
        }
}

uint8_t *sv_wall_brightest(const sv_wall_layout *l, const sv_wall_blocks *b) {
    const size_t count = (size_t)l->columns * l->rows * l->layers;
    const size_t plane = (size_t)l->columns * l->rows;
    uint8_t *rows = calloc(count, 1), *bright = calloc(count, 1);
    if (rows && bright) {
        for (size_t i = 0; i < count; i++) {
            const uint32_t behind = i + plane < count ? b->means[i + plane] : 0;
            bright[i] = (uint8_t)((b->means[i] + behind + 1) / 2);
        }
        largest_along(bright, rows, (size_t)l->rows * l->layers, l->columns, 1, l->beside[0]);
        largest_along(rows, bright, l->layers, l->rows, l->columns, l->beside[1]);
        free(rows);
        return bright;
    }
    free(rows);
    free(bright);
    return NULL;
}
