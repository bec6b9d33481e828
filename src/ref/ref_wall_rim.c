/* SPDX-License-Identifier: MIT */
/* Where a ray has no fluid of its own, the surface goes on from the rays that have: from the rim of the sac.
 * A pyramid of grids, each half as wide as the one before: cells that are known tell coarser ones, and these
 * tell what is not known. */
#include "ref/ref_wall_steps.h"

#include <math.h>
#include <stdlib.h>

/* A cell of a grid; a ray in the finest one. */
typedef struct {
    uint32_t place[SV_WALL_PLACES]; /* in units of 1 / SV_WALL_PLACE_ONE layers */
    uint32_t known;                 /* 1: by its rays, or told by others; 0: nobody knows */
} rim_cell;

/* Which cells of a coarser grid lie around cell `at` of `count` along an axis, and their weights, of 4. */
typedef struct {
    uint32_t cell[2], weight[2];
} rim_pair;

bool sv_wall_has_fluid(const sv_wall_scan *s, size_t ray, float place, uint32_t shown) {
    const sv_wall_layout *l = s->layout;
    const uint32_t end = s->blocks->end[ray], at = (uint32_t)place, reach = l->full_distance;
    if (shown >= SV_WALL_POSSIBLE || sv_wall_first_run(s, ray).begin == end) return true;
    const size_t plane = (size_t)l->columns * l->rows;
    uint32_t dark = 0;
    for (uint32_t z = s->blocks->first[ray]; z < end; z++) {
        const bool near = z <= at + reach && at <= z + reach;
        dark += near && s->blocks->relative[z * plane + ray] <= l->dim;
    }
    return dark >= SV_WALL_OWN_FLUID;
}

/* Tells a cell of half as wide a grid the mean of those it covers that are known. Where the number of cells
 * is odd, the cells overlap, so that a mirrored grid is told the same. `least`: so many must be known. */
static rim_cell mean_of(const rim_cell *fine, const uint32_t n[2], uint32_t least, uint32_t x, uint32_t y) {
    rim_cell mean = {.known = 0};
    uint32_t known = 0;
    for (uint32_t v = 2 * y - (y > 0 && n[1] % 2); v < 2 * y + 2 && v < n[1]; v++)
        for (uint32_t u = 2 * x - (x > 0 && n[0] % 2); u < 2 * x + 2 && u < n[0]; u++) {
            const rim_cell *cell = &fine[(size_t)v * n[0] + u];
            if (!cell->known) continue;
            known++;
            for (int i = 0; i < SV_WALL_PLACES; i++) mean.place[i] += cell->place[i];
        }
    for (int i = 0; known && i < SV_WALL_PLACES; i++) mean.place[i] = (mean.place[i] + known / 2) / known;
    mean.known = known >= least;
    return mean;
}

static rim_pair around(uint32_t at, uint32_t count) {
    const uint32_t last = (count + 1) / 2 - 1, own = at / 2;
    if (count % 2) return (rim_pair){{own, (at + 1) / 2}, {2, 2}};
    const uint32_t beside = at % 2 ? (own < last ? own + 1 : last) : own > 0 ? own - 1 : 0;
    return (rim_pair){{own, beside}, {3, 1}};
}

/* What a coarser grid tells a cell: linear between the four cells around it, rounded half up. These are all
 * known, or none is. */
static rim_cell told_by(const rim_cell *coarse, const uint32_t n[2], uint32_t x, uint32_t y) {
    const rim_pair u = around(x, n[0]), v = around(y, n[1]);
    rim_cell told = {.known = coarse[0].known};
    for (int k = 0; k < 4; k++) {
        const rim_cell *cell = &coarse[(size_t)v.cell[k / 2] * ((n[0] + 1) / 2) + u.cell[k % 2]];
        const uint32_t weight = v.weight[k / 2] * u.weight[k % 2];
        for (int i = 0; i < SV_WALL_PLACES; i++) told.place[i] += weight * cell->place[i];
    }
    for (int i = 0; i < SV_WALL_PLACES; i++) told.place[i] = (told.place[i] + 8) / 16;
    return told;
}

/* Tells all cells of a grid, and of the coarser ones behind it in the array, what is not known. */
static void tell(rim_cell *fine, const uint32_t n[2], uint32_t least) {
    const uint32_t m[2] = {(n[0] + 1) / 2, (n[1] + 1) / 2};
    rim_cell *const coarse = fine + (size_t)n[0] * n[1];
    if (n[0] == 1 && n[1] == 1) return;
    for (uint32_t y = 0; y < m[1]; y++)
        for (uint32_t x = 0; x < m[0]; x++) coarse[(size_t)y * m[0] + x] = mean_of(fine, n, least, x, y);
    tell(coarse, m, 1);
    for (uint32_t y = 0; y < n[1]; y++)
        for (uint32_t x = 0; x < n[0]; x++) {
            rim_cell *const cell = &fine[(size_t)y * n[0] + x];
            if (!cell->known) *cell = told_by(coarse, n, x, y);
        }
}

/* Returns the layer that a ray's surface may go on to, from `from` towards `to`: as long as no layer costs 1
 * more than the cheapest one, `least`. Deeper it would cut a fetus that lies against the wall. */
static uint32_t deepest(const sv_wall_layout *l, const uint32_t *costs, size_t ray, float least,
                        uint32_t from, uint32_t to) {
    const uint32_t x = (uint32_t)(ray % l->columns), y = (uint32_t)(ray / l->columns);
    const uint32_t limit = (uint32_t)(least * SV_WALL_FINE_COST_ONE) + SV_WALL_FINE_COST_ONE;
    uint32_t z = from;
    while (z < to && sv_wall_cost_at(l, costs, x, y, z + 1) < limit) z++;
    return z;
}

/* How sure a surface is that has gone on to `place`: by what it costs there, and less, the more tissue it
 * leaves in front of it. */
static float confidence_at(const sv_wall_scan *s, const uint32_t *costs, size_t ray, float place) {
    const sv_wall_layout *l = s->layout;
    const size_t plane = (size_t)l->columns * l->rows;
    const uint32_t at = (uint32_t)place;
    const uint32_t cost =
        sv_wall_cost_at(l, costs, (uint32_t)(ray % l->columns), (uint32_t)(ray / l->columns), at);
    uint32_t tissue = 0;
    for (uint32_t z = s->blocks->first[ray]; z < at; z++) tissue += sv_wall_is_tissue(s, ray, z);
    const float part = (float)tissue / (float)(2 * l->full_distance);
    return sv_wall_confidence(l, (float)cost / SV_WALL_FINE_COST_ONE,
                              (float)s->blocks->relative[at * plane + ray] / SV_WALL_TISSUE) /
           (1.0f + part * part);
}

bool sv_wall_go_on(const sv_wall_scan *s, const uint32_t *costs, const float *least, const bool *own,
                   float *places, float *confidence) {
    const sv_wall_layout *l = s->layout;
    const uint32_t n[2] = {l->columns, l->rows};
    const size_t count = (size_t)l->columns * l->rows;
    rim_cell *const cells = calloc(sv_wall_pyramid_cells(n[0], n[1]), sizeof *cells);
    if (!cells) return false;
    for (size_t ray = 0; ray < count; ray++) {
        cells[ray].known = own[ray] && s->blocks->first[ray] < s->blocks->end[ray];
        for (size_t i = 0; i < SV_WALL_PLACES; i++)
            cells[ray].place[i] = (uint32_t)(places[i * count + ray] * SV_WALL_PLACE_ONE + 0.5f);
    }
    tell(cells, n, SV_WALL_MAJORITY);
    for (size_t ray = 0; ray < count; ray++) {
        if (own[ray] || !cells[ray].known) continue;
        const uint32_t from = (uint32_t)places[SV_WALL_PLACES / 2 * count + ray];
        const uint32_t to = cells[ray].place[SV_WALL_PLACES / 2] / SV_WALL_PLACE_ONE;
        const float most = (float)deepest(l, costs, ray, least[ray], from, to);
        for (size_t i = 0; i < SV_WALL_PLACES; i++) {
            float *const place = &places[i * count + ray];
            *place = fminf((float)cells[ray].place[i] / SV_WALL_PLACE_ONE, most > *place ? most : *place);
        }
        confidence[ray] = confidence_at(s, costs, ray, places[SV_WALL_PLACES / 2 * count + ray]);
    }
    free(cells);
    return true;
}
