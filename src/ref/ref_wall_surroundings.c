/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <stdlib.h>
#include <string.h>

/* What a cell is in one layer. */
enum { FLUID, TISSUE, WALL, LATER_RUN, FETUS };

/* The sides from which something is reached. */
enum { LEFT = 1, RIGHT = 2, IN_ROW = LEFT | RIGHT, ABOVE = 4, BELOW = 8, IN_COLUMN = ABOVE | BELOW };

/* Counts a ray of a cell in layer z, if it is tissue there. */
static void count_ray(const sv_wall_scan *s, size_t ray, const sv_wall_run *run, size_t z, int *tissue,
                      int *wall) {
    if (z < s->blocks->first[ray] || z >= s->blocks->end[ray] || !sv_wall_is_tissue(s, ray, z)) return;
    ++*tissue;
    *wall += run->touches && z < run->end;
}

/* Classifies a cell by the number of its rays that are tissue, and of these that are wall. */
static uint8_t class_of(int tissue, int wall) {
    if (wall >= SV_WALL_MAJORITY) return WALL;
    if (tissue - wall >= SV_WALL_MAJORITY) return LATER_RUN;
    return tissue >= SV_WALL_MAJORITY ? TISSUE : FLUID;
}

/* Classifies the cells of layer z. `runs`: the first run of every ray. */
static void classify_cells(const sv_wall_scan *s, const sv_wall_run *runs, size_t z, uint8_t *cell_class) {
    const sv_wall_layout *l = s->layout;
    for (size_t y = 0; y < l->cells[1]; y++)
        for (size_t x = 0; x < l->cells[0]; x++) {
            int tissue = 0, wall = 0;
            for (size_t k = 0; k < 4; k++) {
                const size_t ray = (2 * y + k / 2) * l->columns + 2 * x + k % 2;
                count_ray(s, ray, &runs[ray], z, &tissue, &wall);
            }
            cell_class[y * l->cells[0] + x] = class_of(tissue, wall);
        }
}

/* Decides which cells of later runs are the fetus in layer z. */
static void classify_fetus(const sv_wall_scan *s, const sv_wall_evidence *e, size_t z,
                           const uint8_t *surroundings, uint8_t *cell_class) {
    const size_t cells = (size_t)s->layout->cells[0] * s->layout->cells[1];
    for (size_t i = 0; i < cells; i++) {
        const bool is_shown = e->later_run[s->brightness[z * cells + i]] >= SV_WALL_LIKELY;
        if (cell_class[i] == LATER_RUN && !(surroundings[i] & SV_WALL_ENCLOSED) && is_shown)
            cell_class[i] = FETUS;
    }
}

/* Sweeps over `count` cells from `start` on, `step` apart. Cells that `source` reaches through tissue in this
 * direction get the flag `side`. */
static void sweep(const uint8_t *cell_class, uint8_t source, ptrdiff_t start, ptrdiff_t step, uint32_t count,
                  uint8_t side, uint8_t *sides) {
    bool reached = false;
    for (uint32_t i = 0; i < count; i++) {
        const ptrdiff_t at = start + (ptrdiff_t)i * step;
        reached = cell_class[at] == source || (cell_class[at] != FLUID && reached);
        if (reached) sides[at] |= side;
    }
}

/* Finds for every cell of a layer the sides from which `source` reaches it. */
static void sweep_all_sides(const sv_wall_layout *l, const uint8_t *cell_class, uint8_t source,
                            uint8_t *sides) {
    const ptrdiff_t w = l->cells[0], h = l->cells[1];
    memset(sides, 0, (size_t)(w * h));
    for (ptrdiff_t y = 0; y < h; y++) {
        sweep(cell_class, source, y * w, 1, l->cells[0], LEFT, sides);
        sweep(cell_class, source, y * w + w - 1, -1, l->cells[0], RIGHT, sides);
    }
    for (ptrdiff_t x = 0; x < w; x++) {
        sweep(cell_class, source, x, w, l->cells[1], ABOVE, sides);
        sweep(cell_class, source, (h - 1) * w + x, -w, l->cells[1], BELOW, sides);
    }
}

/* True if the wall reaches a cell from at least three sides. */
static bool is_enclosed(uint8_t sides) {
    const bool in_row = (sides & IN_ROW) == IN_ROW, in_column = (sides & IN_COLUMN) == IN_COLUMN;
    return (in_row && (sides & IN_COLUMN)) || (in_column && (sides & IN_ROW));
}

/* Returns the flag of a cell that the fetus reaches from these sides. */
static uint8_t fetus_flag(uint8_t sides) {
    if ((sides & IN_ROW) == IN_ROW || (sides & IN_COLUMN) == IN_COLUMN) return SV_WALL_FLANKED;
    return sides ? SV_WALL_ONE_SIDE : 0;
}

/* Writes the flags of one layer. `cell_class` and `sides` have room for a byte a cell. */
static void classify_layer(const sv_wall_scan *s, const sv_wall_evidence *e, const sv_wall_run *runs,
                           size_t z, uint8_t *cell_class, uint8_t *sides, uint8_t *surroundings) {
    const sv_wall_layout *l = s->layout;
    const size_t cells = (size_t)l->cells[0] * l->cells[1];
    classify_cells(s, runs, z, cell_class);
    sweep_all_sides(l, cell_class, WALL, sides);
    for (size_t i = 0; i < cells; i++) surroundings[i] = is_enclosed(sides[i]) ? SV_WALL_ENCLOSED : 0;
    classify_fetus(s, e, z, surroundings, cell_class);
    sweep_all_sides(l, cell_class, FETUS, sides);
    for (size_t i = 0; i < cells; i++) surroundings[i] |= fetus_flag(sides[i]);
}

uint8_t *sv_wall_surroundings_map(const sv_wall_scan *s, const sv_wall_evidence *evidence) {
    const sv_wall_layout *l = s->layout;
    const size_t cells = (size_t)l->cells[0] * l->cells[1], rays = (size_t)l->columns * l->rows;
    uint8_t *const surroundings = malloc(cells * l->layers), *const cell_class = malloc(cells),
                   *const sides = malloc(cells);
    sv_wall_run *const runs = malloc(rays * sizeof *runs);
    const bool made = surroundings && cell_class && sides && runs;
    for (size_t ray = 0; made && ray < rays; ray++) runs[ray] = sv_wall_first_run(s, ray);
    for (size_t z = 0; made && z < l->layers; z++)
        classify_layer(s, evidence, runs, z, cell_class, sides, surroundings + z * cells);
    free(cell_class);
    free(sides);
    free(runs);
    if (made) return surroundings;
    free(surroundings);
    return NULL;
}
