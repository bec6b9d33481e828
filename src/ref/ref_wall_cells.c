/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_cells.h"

#include <stdlib.h>

void sv_wall_cells_destroy(sv_wall_cells *cells) {
    free(cells->away);
    free(cells->wrong);
    *cells = (sv_wall_cells){0};
}

/* The cells that pixel i of `pixels` belongs to, of `cells` in a row: first .. first + count - 1. Each end of
 * the image looks like the other. */
static uint32_t owners(uint32_t i, uint32_t pixels, uint32_t cells, uint32_t *first) {
    const uint32_t at = (2 * i + 1) * cells, width = 2 * pixels;
    *first = at / width;
    if (at % width != 0) return 1;
    (*first)--;
    return 2;
}

typedef struct {
    const sv_wall_scan *scan;
    sv_wall_cells *cells;
    uint32_t *rays; /* weight of the rays of each cell, in quarters */
    uint32_t *away, *wrong;
} collector;

/* Adds the costs of a ray to its cells, in quarters. */
static void add_ray(collector *c, uint32_t x, uint32_t y) {
    const sv_wall_layout *l = c->scan->layout;
    uint32_t cx, cy;
    const uint32_t nx = owners(x, l->width, l->cells_x, &cx), ny = owners(y, l->height, l->cells_y, &cy);
    const uint32_t weight = 4 / (nx * ny);
    for (uint32_t v = cy; v < cy + ny; v++)
        for (uint32_t u = cx; u < cx + nx; u++) {
            const size_t cell = (size_t)v * l->cells_x + u;
            c->rays[cell] += weight;
            for (uint32_t i = 0; i < l->labels; i++) {
                c->cells->away[cell * l->labels + i] += weight * c->away[i];
                c->cells->wrong[cell * l->labels + i] += weight * c->wrong[i];
            }
        }
}

/* Sums of quarters to means in units of 1 / SV_WALL_CELL_ONE. */
static uint32_t mean(uint32_t sum, uint32_t rays) {
    const uint64_t scaled = (uint64_t)sum * (SV_WALL_CELL_ONE / SV_WALL_ONE);
    return (uint32_t)((scaled + rays / 2) / rays);
}

static bool collect(collector *c) {
    const sv_wall_layout *l = c->scan->layout;
    sv_wall_ray ray;
    if (!sv_wall_ray_create(l, &ray)) return false;
    for (uint32_t y = 0; y < l->height; y++)
        for (uint32_t x = 0; x < l->width; x++)
            if (sv_wall_costs(c->scan, (size_t)y * l->width + x, &ray, c->away, c->wrong)) {
                add_ray(c, x, y);
                c->cells->fetus += ray.begun[l->slices];
            }
    sv_wall_ray_destroy(&ray);
    for (size_t cell = 0; cell < (size_t)l->cells_x * l->cells_y; cell++)
        for (uint32_t i = 0; c->rays[cell] && i < l->labels; i++) {
            uint32_t *away = c->cells->away + cell * l->labels + i,
                     *wrong = c->cells->wrong + cell * l->labels + i;
            *away = mean(*away, c->rays[cell]);
            *wrong = mean(*wrong, c->rays[cell]);
        }
    return true;
}

bool sv_wall_cells_create(const sv_wall_scan *scan, sv_wall_cells *cells) {
    const sv_wall_layout *l = scan->layout;
    const size_t count = (size_t)l->cells_x * l->cells_y;
    *cells = (sv_wall_cells){.away = calloc(count * l->labels, sizeof(uint32_t)),
                             .wrong = calloc(count * l->labels, sizeof(uint32_t))};
    collector c = {scan, cells, calloc(count, sizeof(uint32_t)), calloc(l->labels, sizeof(uint32_t)),
                   calloc(l->labels, sizeof(uint32_t))};
    const bool done = cells->away && cells->wrong && c.rays && c.away && c.wrong && collect(&c);
    free(c.rays);
    free(c.away);
    free(c.wrong);
    if (!done) sv_wall_cells_destroy(cells);
    return done;
}
