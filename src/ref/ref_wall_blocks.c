/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <stdlib.h>
#include <string.h>

/* First scanned slice of a ray of voxels, and the first one behind the scan. */
static uint32_t first_slice(const sv_wall_volume *v, size_t pixel) {
    return v->first ? v->first[pixel] : 0;
}

static uint32_t end_slice(const sv_wall_volume *v, size_t pixel) {
    return v->end ? v->end[pixel] : v->slices;
}

/* Finds the layers at which all voxels of a ray of blocks were scanned. */
static void find_range(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_span *sx,
                       const sv_wall_span *sy, uint16_t *first, uint16_t *end) {
    uint32_t from = 0, to = l->slices;
    for (uint32_t y = sy->first; y < sy->first + sy->count; y++)
        for (uint32_t x = sx->first; x < sx->first + sx->count; x++) {
            const size_t pixel = (size_t)y * l->width + x;
            if (first_slice(v, pixel) > from) from = first_slice(v, pixel);
            if (end_slice(v, pixel) < to) to = end_slice(v, pixel);
        }
    from = (from + l->depth - 1) / l->depth;
    to = to == l->slices ? l->layers : to / l->depth; /* the last layer may have less slices */
    *first = (uint16_t)(from < to ? from : 0);
    *end = (uint16_t)(from < to ? to : 0);
}

static uint8_t block_mean(const sv_wall_volume *v, const sv_wall_layout *l, const sv_wall_span *sx,
                          const sv_wall_span *sy, uint32_t layer) {
    const uint32_t from = layer * l->depth;
    const uint32_t to = from + l->depth < l->slices ? from + l->depth : l->slices;
    uint32_t sum = 0;
    for (uint32_t z = from; z < to; z++)
        for (uint32_t j = 0; j < sy->count; j++)
            for (uint32_t i = 0; i < sx->count; i++) {
                const size_t row = (size_t)z * l->height + sy->first + j;
                sum += (uint32_t)sx->weight[i] * sy->weight[j] * v->voxels[row * l->width + sx->first + i];
            }
    const uint32_t weight = SV_WALL_SPAN_ONE * SV_WALL_SPAN_ONE * (to - from);
    return (uint8_t)((sum + weight / 2) / weight);
}

/* Smooths the levels along the rays. A layer of one slice is more speckle than tissue: a dark block would
 * split the wall, and a bright one behind it would be the fetus. So a block's neighbours along the ray weigh
 * 1 / SV_WALL_AXIAL_SUM each. The block itself takes the place of one that was not scanned. */
static void smooth_axially(const sv_wall_blocks *b) {
    const size_t plane = (size_t)b->columns * b->rows;
    for (size_t ray = 0; ray < plane; ray++)
        for (size_t z = b->first[ray]; z < b->end[ray]; z++) {
            const uint8_t *own = &b->means[z * plane + ray];
            const uint32_t before = z > b->first[ray] ? *(own - plane) : *own;
            const uint32_t behind = z + 1 < b->end[ray] ? own[plane] : *own;
            const uint32_t sum = (SV_WALL_AXIAL_SUM - 2) * *own + before + behind;
            b->levels[z * plane + ray] = (uint8_t)((sum + SV_WALL_AXIAL_SUM / 2) / SV_WALL_AXIAL_SUM);
        }
}

bool sv_wall_blocks_allocate(const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    *b = (sv_wall_blocks){.columns = l->columns,
                          .rows = l->rows,
                          .layers = l->layers,
                          .means = calloc(plane, l->layers),
                          .levels = calloc(plane, l->layers),
                          .relative = calloc(plane, l->layers),
                          .first = calloc(plane, sizeof(uint16_t)),
                          .end = calloc(plane, sizeof(uint16_t))};
    if (b->means && b->levels && b->relative && b->first && b->end) return true;
    sv_wall_blocks_destroy(b);
    return false;
}

bool sv_wall_blocks_create(const sv_wall_volume *v, const sv_wall_layout *l, sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows;
    if (!sv_wall_blocks_allocate(l, b)) return false;
    for (uint32_t y = 0; y < l->rows; y++) {
        const sv_wall_span sy = sv_wall_span_of(y, l->height, l->rows);
        for (uint32_t x = 0; x < l->columns; x++) {
            const sv_wall_span sx = sv_wall_span_of(x, l->width, l->columns);
            const size_t ray = (size_t)y * l->columns + x;
            find_range(v, l, &sx, &sy, &b->first[ray], &b->end[ray]);
            b->rays += b->first[ray] < b->end[ray];
            for (uint32_t z = b->first[ray]; z < b->end[ray]; z++)
                b->means[z * plane + ray] = block_mean(v, l, &sx, &sy, z);
        }
    }
    if (l->smoothed)
        smooth_axially(b);
    else
        memcpy(b->levels, b->means, plane * l->layers);
    return true;
}

void sv_wall_blocks_destroy(sv_wall_blocks *b) {
    free(b->means);
    free(b->levels);
    free(b->relative);
    free(b->first);
    free(b->end);
    *b = (sv_wall_blocks){0};
}

static uint8_t maximum_of(const uint8_t *from, size_t stride, size_t count) {
    uint8_t maximum = 0;
    for (size_t k = 0; k < count; k++)
        if (from[k * stride] > maximum) maximum = from[k * stride];
    return maximum;
}

/* Grey dilation along one axis: `groups` lines of `count` values that lie `stride` apart. */
static void dilate(const uint8_t *from, uint8_t *to, size_t groups, size_t count, size_t stride,
                   size_t reach) {
    for (size_t group = 0; group < groups; group++, from += count * stride)
        for (size_t at = 0; at < count; at++) {
            const size_t low = at < reach ? 0 : at - reach,
                         high = at + reach < count ? at + reach : count - 1;
            for (size_t i = 0; i < stride; i++)
                *to++ = maximum_of(from + low * stride + i, stride, high - low + 1);
        }
}

/* Takes the maximum of the four rays of every cell. */
static void maximum_of_cells(const sv_wall_layout *l, const uint8_t *rays, uint8_t *cells) {
    for (uint32_t z = 0; z < l->layers; z++)
        for (uint32_t y = 0; y < l->cells[1]; y++)
            for (uint32_t x = 0; x < l->cells[0]; x++) {
                const uint8_t *const at =
                    rays + ((size_t)z * l->rows + (size_t)2 * y) * l->columns + (size_t)2 * x;
                const uint8_t above = maximum_of(at, 1, 2), below = maximum_of(at + l->columns, 1, 2);
                *cells++ = above > below ? above : below;
            }
}

uint8_t *sv_wall_brightness_map(const sv_wall_layout *l, const sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows, count = plane * l->layers;
    uint8_t *means = calloc(count, 1), *cells = calloc(count, 1);
    if (means && cells) {
        for (size_t i = 0; i < count; i++) {
            const uint32_t behind = i + plane < count ? b->means[i + plane] : 0;
            means[i] = (uint8_t)((b->means[i] + behind + 1) / 2);
        }
        maximum_of_cells(l, means, cells);
        dilate(cells, means, (size_t)l->cells[1] * l->layers, l->cells[0], 1, l->dilation[0]);
        dilate(means, cells, l->layers, l->cells[1], l->cells[0], l->dilation[1]);
        free(means);
        return cells;
    }
    free(means);
    free(cells);
    return NULL;
}
