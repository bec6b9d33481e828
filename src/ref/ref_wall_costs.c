/* SPDX-License-Identifier: MIT */
#include "ref/ref_wall_steps.h"

#include <stdlib.h>

#define RAYS_OF_CELL 4

/* What is known of a ray, by layer. The arrays are allocated once for all rays. */
typedef struct {
    uint32_t *cumulative; /* probability that the fetus begins in the layer or in front of it */
    uint32_t *later;      /* probability that it begins with a run whose fluid begins behind the layer, or in
                             front of it, if that is no fluid */
    uint32_t *distance;   /* to the ray's fluid, layers; UINT32_MAX: there is none */
    sv_wall_run first;
    uint32_t fluid_begin, fluid_end; /* where the surface belongs if no fetus is seen */
} ray_facts;

/* Shares of probabilities, rounded half up. */
static uint32_t share(uint32_t value, uint32_t probability) {
    return (uint32_t)(((uint64_t)value * probability + SV_WALL_PROBABILITY_ONE / 2) /
                      SV_WALL_PROBABILITY_ONE);
}

/* Shares of costs, rounded down. */
static uint32_t share_of_cost(uint32_t cost, uint32_t probability) {
    return (uint32_t)((uint64_t)cost * probability / SV_WALL_PROBABILITY_ONE);
}

/* Returns the probability that a block of tissue is the fetus. Enclosed tissue is judged like a first run. Of
 * a first run, what the fetus flanks is judged like a later run; what it reaches from one side is moved by
 * `one_side` from the one probability to the other. */
static uint32_t fetus_probability(const sv_wall_scan *s, const sv_wall_evidence *e, size_t ray, uint32_t z,
                                  const sv_wall_run *first) {
    const uint8_t brightness = sv_wall_brightness_at(s, ray, z);
    const uint32_t as_first = e->first_run[brightness], as_later = e->later_run[brightness];
    const uint8_t flags = sv_wall_surroundings_at(s, ray, z);
    if (flags & SV_WALL_FLOATS) return as_later;
    if (!first->touches || z >= first->end) return flags & SV_WALL_ENCLOSED ? as_first : as_later;
    if (z < first->begin + s->layout->skin) return 0; /* the skin tells nothing */
    if (flags & SV_WALL_FLANKED) return as_later;
    return as_first + (flags & SV_WALL_ONE_SIDE ? share(as_later - as_first, s->layout->one_side) : 0);
}

/* Forward pass: accumulates the probability that the fetus has begun. A run counts by the largest probability
 * that it has shown so far. */
static void forward_fetus(const sv_wall_scan *s, const sv_wall_evidence *e, size_t ray, ray_facts *f) {
    /* Probability that the fetus has not begun before this run, and up to this layer. */
    uint32_t before = SV_WALL_PROBABILITY_ONE, now = SV_WALL_PROBABILITY_ONE;
    uint32_t maximum = 0;
    for (uint32_t z = 0; z < s->layout->layers; z++) {
        if (sv_wall_is_tissue(s, ray, z)) {
            const uint32_t p = fetus_probability(s, e, ray, z, &f->first);
            if (p > maximum) maximum = p;
            now = before - share(before, maximum);
        } else {
            before = now;
            maximum = 0;
        }
        f->cumulative[z] = SV_WALL_PROBABILITY_ONE - now;
    }
}

/* Distance transform of one line: sets every distance to that of the nearest zero, if there is one. */
static void spread_distance(uint32_t *distance, uint32_t layers) {
    for (uint32_t z = 1; z < layers; z++)
        if (distance[z - 1] != UINT32_MAX && distance[z - 1] + 1 < distance[z])
            distance[z] = distance[z - 1] + 1;
    for (uint32_t z = layers - 1; z > 0; z--)
        if (distance[z] != UINT32_MAX && distance[z] + 1 < distance[z - 1]) distance[z - 1] = distance[z] + 1;
}

/* How certain it is that layers begin .. end - 1 of a ray are fluid. Fluid that ends a first run is. Behind
 * it bone, a shadow or the mother's tissue may be dim, too: there the darkest block counts, from the
 * threshold to dark, squared. */
static uint32_t certainty(const sv_wall_scan *s, size_t ray, const sv_wall_run *first, uint32_t begin,
                          uint32_t end) {
    const sv_wall_layout *l = s->layout;
    const size_t plane = (size_t)l->columns * l->rows;
    if (first->touches && begin == first->end) return SV_WALL_PROBABILITY_ONE;
    uint32_t level = SV_WALL_TISSUE;
    for (uint32_t z = begin; z < end; z++)
        if (s->blocks->relative[z * plane + ray] < level) level = s->blocks->relative[z * plane + ray];
    if (level <= l->dim) return SV_WALL_PROBABILITY_ONE;
    const uint32_t dark = (SV_WALL_TISSUE - level) * l->darkness;
    return share(dark, dark);
}

/* Backward pass: finds the probability of the run behind each stretch of fluid, and the distance to the
 * fluid. */
static void backward_fluid(const sv_wall_scan *s, size_t ray, ray_facts *f) {
    const uint32_t layers = s->layout->layers, start = s->blocks->first[ray];
    for (uint32_t z = 0; z < layers; z++) f->later[z] = 0;
    for (uint32_t z = 0; z < layers; z++) f->distance[z] = UINT32_MAX;
    for (uint32_t z = s->blocks->end[ray]; z > start;) {
        const uint32_t run_end = z;
        while (z > start && sv_wall_is_tissue(s, ray, z - 1)) z--;
        const uint32_t run = z;
        while (z > start && !sv_wall_is_tissue(s, ray, z - 1)) z--;
        const bool open_front = z == start && z < run;
        for (uint32_t i = open_front ? 0 : z; i < run; i++) f->distance[i] = 0;
        if (z == start || run == run_end) continue;
        const uint32_t begins = f->cumulative[run_end - 1] - f->cumulative[run - 1];
        const uint32_t doubt = begins - share(begins, certainty(s, ray, &f->first, z, run));
        for (uint32_t i = 0; i < layers; i++) f->later[i] += i < z ? begins : doubt;
    }
    spread_distance(f->distance, layers);
}

/* Finds the first fluid: behind a first run that touches the scan's start, else all in front of the run. */
static void first_fluid(const sv_wall_scan *s, size_t ray, ray_facts *f) {
    f->fluid_begin = 0;
    f->fluid_end = f->first.begin;
    if (!f->first.touches || !f->first.fluid) return;
    f->fluid_begin = f->fluid_end = f->first.end;
    while (f->fluid_end < s->blocks->end[ray] && !sv_wall_is_tissue(s, ray, f->fluid_end)) f->fluid_end++;
}

/* Returns what a surface in layer z costs but for the distance to the fluid. In a first run a fetus that
 * begins up to `skin` layers behind is not hidden: bone lies that far behind its skin. */
static uint32_t error_cost(const sv_wall_layout *l, bool bare, const ray_facts *f, uint32_t z) {
    const uint32_t none = SV_WALL_PROBABILITY_ONE - f->cumulative[l->layers - 1];
    uint32_t later = f->later[z];
    if (f->first.touches && z < f->first.end) {
        const uint32_t skin = z + l->skin < f->first.end ? z + l->skin : f->first.end - 1;
        later += f->cumulative[f->first.end - 1] - f->cumulative[skin];
    }
    uint32_t cost = share_of_cost(l->occluder_cost, later);
    if (z > 0 || !bare) cost += share_of_cost(l->cut_cost, f->cumulative[z]);
    if (z < f->fluid_begin || z >= f->fluid_end) cost += share_of_cost(SV_WALL_COST_ONE, none);
    return cost;
}

/* Adds the costs of a ray to those of its cell. */
static void add_ray(const sv_wall_layout *l, bool bare, const ray_facts *f, uint32_t *all) {
    for (uint32_t z = 0; z < l->layers; z++) {
        const uint32_t layers = f->distance[z] < l->full_distance ? f->distance[z] : l->full_distance;
        const uint32_t cost = (layers * l->rate + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS;
        const uint32_t capped = cost < SV_WALL_COST_ONE ? cost : SV_WALL_COST_ONE;
        all[z] += capped + error_cost(l, bare, f, z);
    }
}

static void facts_free(ray_facts *f) {
    free(f->cumulative);
    free(f->later);
    free(f->distance);
}

static bool facts_make(uint32_t layers, ray_facts *f) {
    *f = (ray_facts){.cumulative = calloc(layers, sizeof(uint32_t)),
                     .later = calloc(layers, sizeof(uint32_t)),
                     .distance = calloc(layers, sizeof(uint32_t))};
    if (f->cumulative && f->later && f->distance) return true;
    facts_free(f);
    return false;
}

/* Finds where the run begins in which the fetus has more likely begun than not. A run at the start of the
 * scan has no fluid in front of it. */
static uint16_t find_front(const sv_wall_scan *s, size_t ray, const ray_facts *f) {
    const uint32_t layers = s->layout->layers, start = s->blocks->first[ray];
    uint32_t z = start;
    while (z < layers && f->cumulative[z] < SV_WALL_LIKELY) z++;
    while (z > start && z < layers && sv_wall_is_tissue(s, ray, z - 1)) z--;
    return (uint16_t)(z > start ? z : layers);
}

bool sv_wall_costs_create(const sv_wall_scan *s, const sv_wall_evidence *e, sv_wall_costs *costs) {
    const sv_wall_layout *l = s->layout;
    const size_t rays = (size_t)l->columns * l->rows, count = (size_t)l->cells[0] * l->cells[1] * l->layers;
    ray_facts f;
    *costs = (sv_wall_costs){.all = calloc(count, sizeof(uint32_t)),
                             .fronts = calloc(rays, sizeof(uint16_t)),
                             .shown = calloc(rays, sizeof(uint16_t))};
    if (!costs->all || !costs->fronts || !costs->shown || !facts_make(l->layers, &f)) {
        sv_wall_costs_destroy(costs);
        return false;
    }
    for (size_t ray = 0; ray < rays; ray++) {
        costs->fronts[ray] = (uint16_t)l->layers;
        if (s->blocks->first[ray] == s->blocks->end[ray]) continue;
        f.first = sv_wall_first_run(s, ray);
        forward_fetus(s, e, ray, &f);
        backward_fluid(s, ray, &f);
        first_fluid(s, ray, &f);
        const size_t cell = ray / l->columns / 2 * l->cells[0] + ray % l->columns / 2;
        add_ray(l, e->bare, &f, costs->all + cell * l->layers);
        costs->fronts[ray] = find_front(s, ray, &f);
        costs->shown[ray] = (uint16_t)f.cumulative[l->layers - 1];
        costs->fetus += costs->shown[ray];
    }
    for (size_t i = 0; i < count; i++) costs->all[i] = (costs->all[i] + RAYS_OF_CELL / 2) / RAYS_OF_CELL;
    facts_free(&f);
    return true;
}

void sv_wall_costs_destroy(sv_wall_costs *costs) {
    free(costs->all);
    free(costs->fronts);
    free(costs->shown);
    *costs = (sv_wall_costs){0};
}
