/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_enclosed.h"

#include <stdlib.h>

/* What a cell is in one layer. */
enum { FLUID, TISSUE, WALL };

/* Adds a layer of a ray to what its cell counts. */
static void count_ray(const sv_wall_scan *s, size_t ray, const sv_wall_run *run, size_t z, int *tissue,
                      int *wall) {
    if (z < s->blocks->first[ray] || z >= s->blocks->end[ray] || !sv_wall_is_tissue(s, ray, z)) return;
    ++*tissue;
    *wall += run->touches && z < run->end;
}

/* Of one layer. `runs`: the first tissue of every ray. */
static void tell_cells(const sv_wall_scan *s, const sv_wall_run *runs, size_t z, uint8_t *kind) {
    const sv_wall_layout *l = s->layout;
    for (size_t y = 0; y < l->cells[1]; y++)
        for (size_t x = 0; x < l->cells[0]; x++) {
            int tissue = 0, wall = 0;
            for (size_t k = 0; k < 4; k++) {
                const size_t ray = (2 * y + k / 2) * l->columns + 2 * x + k % 2;
                count_ray(s, ray, &runs[ray], z, &tissue, &wall);
            }
            kind[y * l->cells[0] + x] = wall >= SV_WALL_MOST_RAYS     ? WALL
                                        : tissue >= SV_WALL_MOST_RAYS ? TISSUE
                                                                      : FLUID;
        }
}

/* Cells at `start`, then every `step` further, `count` of them: those that the wall reaches, going that way,
 * are counted once more. */
static void go(const uint8_t *kind, ptrdiff_t start, ptrdiff_t step, uint32_t count, uint8_t *ways) {
    bool reached = false;
    for (uint32_t i = 0; i < count; i++) {
        const ptrdiff_t at = start + (ptrdiff_t)i * step;
        reached = kind[at] == WALL || (kind[at] == TISSUE && reached);
        ways[at] = (uint8_t)(ways[at] + reached);
    }
}

/* From each of the four sides. */
static void go_all_ways(const sv_wall_layout *l, const uint8_t *kind, uint8_t *ways) {
    const ptrdiff_t w = l->cells[0], h = l->cells[1];
    for (ptrdiff_t y = 0; y < h; y++) {
        go(kind, y * w, 1, l->cells[0], ways);
        go(kind, y * w + w - 1, -1, l->cells[0], ways);
    }
    for (ptrdiff_t x = 0; x < w; x++) {
        go(kind, x, w, l->cells[1], ways);
        go(kind, (h - 1) * w + x, -w, l->cells[1], ways);
    }
}

uint8_t *sv_wall_enclosed(const sv_wall_scan *s) {
    const sv_wall_layout *l = s->layout;
    const size_t cells = (size_t)l->cells[0] * l->cells[1], rays = (size_t)l->columns * l->rows;
    uint8_t *const enclosed = calloc(cells * l->layers, 1), *const kind = malloc(cells);
    sv_wall_run *const runs = malloc(rays * sizeof *runs);
    const bool made = enclosed && kind && runs;
    for (size_t ray = 0; made && ray < rays; ray++) runs[ray] = sv_wall_first_run(s, ray);
    for (size_t z = 0; made && z < l->layers; z++) {
        uint8_t *const ways = enclosed + z * cells;
        tell_cells(s, runs, z, kind);
        go_all_ways(l, kind, ways);
        for (size_t i = 0; i < cells; i++) ways[i] = ways[i] == 4;
    }
    free(kind);
    free(runs);
    if (made) return enclosed;
    free(enclosed);
    return NULL;
}
