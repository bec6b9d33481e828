/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <stdlib.h>

/* What a sample is. The wall, and what was not scanned, reach through tissue; only what has fluid before it
 * and behind it on its beam may float. */
enum { FLUID, WALL, TISSUE, BETWEEN_FLUID };

/* Limbs are reached from so many sides at most. */
enum { MOST_SIDES = 1 };

/* They are at most so many times `full_distance` thick along their beam. */
enum { THICK = 2 };

/* Classifies the samples of a beam, `plane` apart. Tissue before its first dark sample is wall: what is dim
 * may be haze in it. What has fluid before and behind is a limb if it is thin. */
static void classify_beam(const sv_wall_layout *l, const sv_wall_blocks *b, size_t beam, uint8_t *kind) {
    const size_t plane = (size_t)l->columns * l->rows;
    bool wall = true;
    uint32_t run = 0; /* samples of tissue that end here */
    for (uint32_t z = 0; z < l->layers; z++) {
        const uint8_t level = b->relative[z * plane + beam];
        const bool scanned = z >= b->first[beam] && z < b->end[beam];
        if (scanned && level <= l->dim) wall = false;
        kind[z * plane + beam] = scanned && level <= SV_WALL_TISSUE ? FLUID
                                 : !scanned || wall                 ? WALL
                                                                    : TISSUE;
    }
    for (uint32_t z = 0; z < l->layers; z++) {
        uint8_t *const here = kind + z * plane + beam;
        const bool limb = *here == FLUID && run <= THICK * l->full_distance;
        for (uint32_t i = 1; limb && i <= run; i++) *(here - i * plane) = BETWEEN_FLUID;
        run = *here == TISSUE ? run + 1 : 0;
    }
}

/* Counts for `count` samples from `start` on, `step` apart, whether they are reached from this side. Nothing
 * was scanned outside the grid. */
static void sweep(const uint8_t *kind, ptrdiff_t start, ptrdiff_t step, uint32_t count, uint8_t *sides) {
    bool reached = true;
    for (uint32_t i = 0; i < count; i++) {
        const ptrdiff_t at = start + (ptrdiff_t)i * step;
        reached = kind[at] == WALL || (kind[at] != FLUID && reached);
        sides[at] += reached;
    }
}

static void sweep_layer(const sv_wall_layout *l, const uint8_t *kind, uint8_t *sides) {
    const ptrdiff_t w = l->columns, h = l->rows;
    for (ptrdiff_t y = 0; y < h; y++) {
        sweep(kind, y * w, 1, l->columns, sides);
        sweep(kind, y * w + w - 1, -1, l->columns, sides);
    }
    for (ptrdiff_t x = 0; x < w; x++) {
        sweep(kind, x, w, l->rows, sides);
        sweep(kind, (h - 1) * w + x, -w, l->rows, sides);
    }
}

uint8_t *sv_wall_limbs_of(const sv_wall_layout *l, const sv_wall_blocks *b) {
    const size_t plane = (size_t)l->columns * l->rows, count = plane * l->layers;
    uint8_t *const kind = calloc(count, 1), *const limbs = calloc(count, 1);
    const bool made = kind && limbs;
    for (size_t beam = 0; made && beam < plane; beam++) classify_beam(l, b, beam, kind);
    for (size_t z = 0; made && z < l->layers; z++) sweep_layer(l, kind + z * plane, limbs + z * plane);
    for (size_t i = 0; made && i < count; i++) limbs[i] = kind[i] == BETWEEN_FLUID && limbs[i] <= MOST_SIDES;
    free(kind);
    if (made) return limbs;
    free(limbs);
    return NULL;
}
