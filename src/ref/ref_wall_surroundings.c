/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_surroundings.h"

#include <stdlib.h>
#include <string.h>

/* What a cell is in one layer. */
enum { FLUID, TISSUE, WALL, LATER_RUN, FETUS };

/* From where something is reached. */
enum { LEFT = 1, RIGHT = 2, ACROSS = LEFT | RIGHT, ABOVE = 4, BELOW = 8, DOWN = ABOVE | BELOW };

/* Adds a layer of a ray to what its cell counts. */
static void count_ray(const sv_wall_scan *s, size_t ray, const sv_wall_run *run, size_t z, int *tissue,
                      int *wall) {
    if (z < s->blocks->first[ray] || z >= s->blocks->end[ray] || !sv_wall_is_tissue(s, ray, z)) return;
    ++*tissue;
    *wall += run->touches && z < run->end;
}

/* `tissue`: of a cell's rays; `wall`: of these. */
static uint8_t kind_of(int tissue, int wall) {
    if (wall >= SV_WALL_MAJORITY) return WALL;
    if (tissue - wall >= SV_WALL_MAJORITY) return LATER_RUN;
    return tissue >= SV_WALL_MAJORITY ? TISSUE : FLUID;
}

/* Of one layer. `runs`: the first tissue of every ray. */
static void classify_cells(const sv_wall_scan *s, const sv_wall_run *runs, size_t z, uint8_t *kind) {
    const sv_wall_layout *l = s->layout;
    for (size_t y = 0; y < l->cells[1]; y++)
        for (size_t x = 0; x < l->cells[0]; x++) {
            int tissue = 0, wall = 0;
            for (size_t k = 0; k < 4; k++) {
                const size_t ray = (2 * y + k / 2) * l->columns + 2 * x + k % 2;
                count_ray(s, ray, &runs[ray], z, &tissue, &wall);
            }
            kind[y * l->cells[0] + x] = kind_of(tissue, wall);
        }
}

/* Which other tissue of a layer is the fetus. */
static void classify_fetus(const sv_wall_scan *s, const sv_wall_evidence *e, size_t z,
                           const uint8_t *surroundings, uint8_t *kind) {
    const size_t cells = (size_t)s->layout->cells[0] * s->layout->cells[1];
    for (size_t i = 0; i < cells; i++) {
        const bool is_shown = e->other[s->bright[z * cells + i]] >= s->layout->fetus_threshold;
        if (kind[i] == LATER_RUN && !(surroundings[i] & SV_WALL_ENCLOSED) && is_shown) kind[i] = FETUS;
    }
}

/* Cells at `start`, then every `step` further, `count` of them: those that `source` reaches through tissue,
 * going that side, are marked. */
static void sweep(const uint8_t *kind, uint8_t source, ptrdiff_t start, ptrdiff_t step, uint32_t count,
                  uint8_t side, uint8_t *sides) {
    bool reached = false;
    for (uint32_t i = 0; i < count; i++) {
        const ptrdiff_t at = start + (ptrdiff_t)i * step;
        reached = kind[at] == source || (kind[at] != FLUID && reached);
        if (reached) sides[at] |= side;
    }
}

/* From each of the four sides, from none at first. */
static void sweep_all_sides(const sv_wall_layout *l, const uint8_t *kind, uint8_t source, uint8_t *sides) {
    const ptrdiff_t w = l->cells[0], h = l->cells[1];
    memset(sides, 0, (size_t)(w * h));
    for (ptrdiff_t y = 0; y < h; y++) {
        sweep(kind, source, y * w, 1, l->cells[0], LEFT, sides);
        sweep(kind, source, y * w + w - 1, -1, l->cells[0], RIGHT, sides);
    }
    for (ptrdiff_t x = 0; x < w; x++) {
        sweep(kind, source, x, w, l->cells[1], ABOVE, sides);
        sweep(kind, source, (h - 1) * w + x, -w, l->cells[1], BELOW, sides);
    }
}

/* How a cell lies to the fetus that is reached from these sides. */
static uint8_t beside_of(uint8_t sides) {
    if ((sides & ACROSS) == ACROSS || (sides & DOWN) == DOWN) return SV_WALL_FLANKED;
    return sides ? SV_WALL_ONE_SIDE : 0;
}

/* Of one layer. `kind` and `sides` have room for a byte a cell. */
static void classify_layer(const sv_wall_scan *s, const sv_wall_evidence *e, const sv_wall_run *runs,
                           size_t z, uint8_t *kind, uint8_t *sides, uint8_t *surroundings) {
    const sv_wall_layout *l = s->layout;
    const size_t cells = (size_t)l->cells[0] * l->cells[1];
    classify_cells(s, runs, z, kind);
    sweep_all_sides(l, kind, WALL, sides);
    for (size_t i = 0; i < cells; i++) surroundings[i] = sides[i] == (ACROSS | DOWN) ? SV_WALL_ENCLOSED : 0;
    classify_fetus(s, e, z, surroundings, kind);
    sweep_all_sides(l, kind, FETUS, sides);
    for (size_t i = 0; i < cells; i++) surroundings[i] |= beside_of(sides[i]);
}

uint8_t *sv_wall_find_surroundings(const sv_wall_scan *s, const sv_wall_evidence *evidence) {
    const sv_wall_layout *l = s->layout;
    const size_t cells = (size_t)l->cells[0] * l->cells[1], rays = (size_t)l->columns * l->rows;
    uint8_t *const surroundings = malloc(cells * l->layers), *const kind = malloc(cells),
                   *const sides = malloc(cells);
    sv_wall_run *const runs = malloc(rays * sizeof *runs);
    const bool made = surroundings && kind && sides && runs;
    for (size_t ray = 0; made && ray < rays; ray++) runs[ray] = sv_wall_first_run(s, ray);
    for (size_t z = 0; made && z < l->layers; z++)
        classify_layer(s, evidence, runs, z, kind, sides, surroundings + z * cells);
    free(kind);
    free(sides);
    free(runs);
    if (made) return surroundings;
    free(surroundings);
    return NULL;
}
