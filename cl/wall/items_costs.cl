/* SPDX-License-Identifier: MIT */
/*
 * By work items: what every cell of two by two rays pays for being clipped at every layer. A ray has a
 * forward and a backward pass, as in wall_costs.cl. Its costs are kept in `scratch` until its cell takes the
 * mean.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* The state of a ray. */
typedef struct {
    __global const uchar *levels, *brightness,
        *flags;                     /* of the first layer; brightness and flags are those of the ray's cell */
    size_t level_pitch, cell_pitch; /* from one layer to the next */
    __global const uint *probabilities;
    bool bare;                     /* there is no wall */
    uint first, end, run, run_end; /* scanned layers, the first run */
    bool scanned, touches;         /* the first run begins where the scan does */
    uint fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    uint fetus, in_run;            /* probability of a fetus; of one that begins in the first run */
    uint doubt;                    /* probability of a fetus that begins with a run behind what is no fluid */
    uint front;                    /* RAY_FRONT */
} ray_t;

/* What is kept of the layers of a ray, `pitch` apart. */
typedef struct {
    __global ushort *fetus; /* probability that the fetus has begun */
    __global ushort *costs;
    __global uchar *near; /* distance to the fluid in front */
    size_t pitch;
} layers_t;

/* Returns the layers of a ray in `scratch`, which has two planes of 16 bits a block and one of 8 bits. */
static layers_t layers_of(const sv_wall_layout *l, __global ushort *scratch, uint row, uint x) {
    const size_t plane = block_row(l, l->layers, 0), at = block_row(l, 0, row) + x;
    return (layers_t){scratch + at, scratch + plane + at, (__global uchar *)(scratch + 2 * plane) + at,
                      block_row(l, 1, 0)};
}

/* Multiplies probabilities, rounding half up. */
static uint share(uint value, uint probability) {
    return (value * probability + SV_WALL_PROBABILITY_ONE / 2u) / (uint)SV_WALL_PROBABILITY_ONE;
}

/* Multiplies a cost by a probability, rounding down. */
static uint share_of_cost(uint cost, uint probability) {
    return cost * probability / (uint)SV_WALL_PROBABILITY_ONE;
}

/* Returns the probability that tissue is the fetus. */
static uint probability_at(const sv_wall_layout *l, const ray_t *r, uint z) {
    const size_t at = z * r->cell_pitch;
    const uint flags = r->flags[at], probability = r->probabilities[r->brightness[at]];
    const uint any = probability >> 16, first = probability & 0xffffu;
    if (flags & CELL_FLOATS) return any;
    if (!r->touches || r->run_end <= z) return (flags & CELL_ENCLOSED) ? first : any;
    if (z < r->run + l->skin) return 0; /* the skin tells nothing */
    if (flags & CELL_FLANKED) return any;
    return (flags & CELL_ADJACENT) ? first + share(any - first, l->one_side) : first;
}

/* Returns how certain fluid is: fully if it is `known`, else by the level of its darkest block. */
static uint certainty_of(const sv_wall_layout *l, uint level, bool known) {
    const uint dark = (SV_WALL_TISSUE - level) * l->darkness;
    return known || level <= l->dim ? (uint)SV_WALL_PROBABILITY_ONE : share(dark, dark);
}

/* Returns what remains of a probability if there is no fluid. */
static uint doubt_of(uint probability, uint certain) {
    return probability - share(probability, certain);
}

/* Walks all layers from front to back. */
static void forward_pass(const sv_wall_layout *l, ray_t *r, const layers_t *s) {
    uint before = SV_WALL_PROBABILITY_ONE, now = before, maximum = 0, near = l->full_distance;
    uint darkest = SV_WALL_TISSUE, certain = SV_WALL_PROBABILITY_ONE;
    uint begin = 0;
    bool behind = false, over = false;
    r->fluid_end = r->end;
    r->doubt = 0;
    r->front = l->layers;
    for (uint z = 0; z < l->layers; z++) {
        const uint level = r->levels[z * r->level_pitch];
        const bool tissue = level > SV_WALL_TISSUE;
        if (behind && !tissue) r->doubt += doubt_of(before - now, certain);
        if (tissue && !behind && r->run_end < z) /* fluid that ends a first run is certain */
            certain = certainty_of(l, darkest, r->touches && !over);
        if (tissue && !behind) begin = z;
        darkest = tissue ? (uint)SV_WALL_TISSUE : min(darkest, level);
        if (tissue) {
            maximum = max(maximum, probability_at(l, r, z));
            now = before - share(before, maximum);
            if (r->front == l->layers && now <= SV_WALL_PROBABILITY_ONE - SV_WALL_LIKELY) r->front = begin;
            if (!behind && r->run_end < z && !over) { /* tissue behind the first fluid */
                r->fluid_end = z;
                over = true;
            }
        } else {
            before = now;
            maximum = 0;
        }
        const bool open_front = r->scanned && !r->touches && z < r->first;
        const bool fluid = open_front || (!tissue && z >= r->first && z < r->end);
        near = fluid ? 0 : min(near + 1, l->full_distance);
        s->fetus[z * s->pitch] = (ushort)(SV_WALL_PROBABILITY_ONE - now);
        s->near[z * s->pitch] = (uchar)near;
        behind = tissue;
    }
    if (behind) r->doubt += doubt_of(before - now, certain);
    r->fetus = SV_WALL_PROBABILITY_ONE - now;
}

/* Finds the first fluid after the forward pass. With an open front, or without fluid, the surface belongs in
 * front of the tissue. A run at the start of the scan has no fluid in front of it. */
static void forward_end(const sv_wall_layout *l, ray_t *r, const layers_t *s) {
    const bool in_front = !(r->touches && r->run_end < r->end);
    r->fluid = in_front ? 0 : r->run_end;
    r->fluid_end = in_front ? r->run : r->fluid_end;
    if (r->front == r->first) r->front = l->layers;
    if (r->front == l->layers && r->fetus >= SV_WALL_POSSIBLE) r->front = SV_WALL_NO_FRONT;
    r->in_run = r->touches && r->run_end > r->run ? s->fetus[(r->run_end - 1) * s->pitch] : 0;
}

/* Returns what a ray pays in layer z but for the distance. `later`: probability that the fetus begins with a
 * run whose fluid is behind the layer. */
static uint error_cost(const sv_wall_layout *l, const ray_t *r, const layers_t *s, uint z, uint later) {
    const uint skin = z + l->skin;
    if (r->touches && skin < r->run_end) later += r->in_run - s->fetus[skin * s->pitch];
    uint cost = share_of_cost(l->occluder_cost, later);
    if (z > 0 || !r->bare) cost += share_of_cost(l->cut_cost, s->fetus[z * s->pitch]);
    if (z < r->fluid || z >= r->fluid_end)
        cost += share_of_cost(SV_WALL_COST_ONE, SV_WALL_PROBABILITY_ONE - r->fetus);
    return cost;
}

static uint distance_cost_at(const sv_wall_layout *l, uint near) {
    const uint far = (near * l->rate + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS;
    return min(far, (uint)SV_WALL_COST_ONE);
}

/* Walks all layers from back to front, and stores the costs of the ray. */
static void backward_pass(const sv_wall_layout *l, const ray_t *r, const layers_t *s) {
    bool behind = false, fluid_behind = false;
    uint later = r->doubt, run_end = r->fetus, near = l->full_distance, darkest = SV_WALL_TISSUE;
    for (uint z = l->layers; z-- > 0;) {
        const uint level = r->levels[z * r->level_pitch];
        const bool tissue = level > SV_WALL_TISSUE;
        const uint fetus = s->fetus[z * s->pitch], before = s->near[z * s->pitch];
        if (tissue && fluid_behind)
            later += share(run_end - fetus, certainty_of(l, darkest, r->touches && z + 1 == r->run_end));
        if (tissue && !behind) run_end = fetus;
        darkest = tissue ? (uint)SV_WALL_TISSUE : min(darkest, level);
        fluid_behind = before == 0;
        behind = tissue;
        near = fluid_behind ? 0 : min(near + 1, l->full_distance);
        const uint cost = distance_cost_at(l, min(near, before)) + error_cost(l, r, s, z, later);
        s->costs[z * s->pitch] = (ushort)(r->scanned ? cost : 0);
    }
}

static void load_ray(const sv_wall_layout *l, __global const ushort *rays, uint x, uint row, ray_t *r) {
    r->first = rays[block_row(l, RAY_FIRST, row) + x];
    r->end = rays[block_row(l, RAY_END, row) + x];
    r->run = rays[block_row(l, RAY_RUN, row) + x];
    r->run_end = rays[block_row(l, RAY_RUN_END, row) + x];
    r->scanned = r->end > r->first;
    r->touches = r->scanned && r->run == r->first;
}

/* One work item per ray: stores what is kept of its layers, and RAY_FRONT. */
__kernel void wall_items_costs(sv_wall_layout l, __global const uint *restrict info,
                               __global const uchar *restrict levels,
                               __global const uchar *restrict brightness,
                               __global const uchar *restrict flags, __global ushort *restrict rays,
                               __global ushort *restrict scratch) {
    const uint x = (uint)get_global_id(0), row = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const layers_t s = layers_of(&l, scratch, row, x);
    ray_t r = {.probabilities = info + SV_WALL_INFO_PROBABILITIES, .bare = info[SV_WALL_INFO_BARE] != 0};
    r.levels = levels + level_row(&l, 0, row) + x;
    r.level_pitch = level_pitch_of(&l);
    r.brightness = brightness + cell_row(&l, 0, row / 2) + x / 2;
    r.flags = flags + cell_row(&l, 0, row / 2) + x / 2;
    r.cell_pitch = cell_row(&l, 1, 0);
    load_ray(&l, rays, x, row, &r);
    forward_pass(&l, &r, &s);
    forward_end(&l, &r, &s);
    rays[block_row(&l, RAY_FRONT, row) + x] = (ushort)r.front;
    backward_pass(&l, &r, &s);
}

/* One work group per row of cells, after wall_items_costs. It stores the means of the cells' rays, rounded
 * half up, and the sum over the rays of the probability that the fetus is on them. A ray that was not scanned
 * counts as 0. */
__kernel void wall_items_cells(sv_wall_layout l, __global const uint *restrict info,
                               __global ushort *restrict scratch, __global ushort *restrict costs,
                               __global ulong *restrict fetus) {
    __local uint sum;
    const uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), row = (uint)get_group_id(0);
    const bool wanted = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    const uint count = wanted ? l.cells[0] * l.layers : 0, rays = wanted ? 2 * l.columns : 0;
    if (item == 0) sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < rays; i += items) {
        const ray_place_t at = ray_of_group(&l, i);
        const layers_t s = layers_of(&l, scratch, at.row, at.x);
        atomic_add(&sum, (uint)s.fetus[(l.layers - 1) * s.pitch]);
    }
    for (uint i = item; i < count; i += items) {
        const uint x = i % l.cells[0], z = i / l.cells[0];
        const layers_t above = layers_of(&l, scratch, 2 * row, 2 * x);
        const size_t at = z * above.pitch, below = at + block_row(&l, 0, 1), to = cell_row(&l, z, row) + x;
        __global const ushort *cost = above.costs;
        costs[to] = (ushort)((cost[at] + cost[at + 1] + cost[below] + cost[below + 1] + 2u) / 4u);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) fetus[row] = sum;
}
