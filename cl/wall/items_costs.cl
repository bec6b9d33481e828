/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface by work items, costs: what every ray pays for being clipped at every layer. A ray is
 * walked front to back and back to front, as wall_costs.cl does.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* A ray, and what is known of it. */
typedef struct {
    __global const uchar *levels, *bright; /* of the first layer */
    size_t level_pitch, pitch;             /* from one layer to the next, of levels and of all else */
    uint threshold;
    __global const uint *chances;
    bool bare;                     /* there is no wall */
    uint first, end, run, run_end; /* scanned layers, the first tissue */
    bool scanned, touches;         /* the first tissue begins where the scan does */
    uint fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    uint begun, in_run;            /* probability of a fetus; of one that begins in the first tissue */
} ray_t;

/* What is kept of every layer of the ray while it is walked, `pitch` apart. */
typedef struct {
    __global ushort *begun; /* probability that the fetus has begun */
    __global uchar *near;   /* distance to the fluid in front; later what it costs */
} layers_t;

static bool is_tissue(const ray_t *r, uint z) {
    return r->levels[z * r->level_pitch] > r->threshold;
}

/* Shares of a value, rounded half up. */
static uint share(uint value, uint chance) {
    return (value * chance + SV_WALL_SURE / 2u) / (uint)SV_WALL_SURE;
}

/* Front to back. */
static void walk_forth(const sv_wall_layout *l, ray_t *r, const layers_t *s) {
    uint before = SV_WALL_SURE, now = before, most = 0, near = l->far;
    bool behind = false, over = false;
    r->fluid_end = r->end;
    for (uint z = 0; z < l->layers; z++) {
        const bool tissue = is_tissue(r, z);
        if (tissue) {
            const bool at_run = r->touches && r->run_end > z;
            most = max(most, (uint)r->bright[z * r->pitch]);
            now = before - share(before, r->chances[most + (at_run ? 0u : 256u)]);
            if (!behind && r->run_end < z && !over) { /* tissue behind the first fluid */
                r->fluid_end = z;
                over = true;
            }
        } else {
            before = now;
            most = 0;
        }
        const bool open_front = r->scanned && !r->touches && z < r->first;
        const bool fluid = open_front || (!tissue && z >= r->first && z < r->end);
        near = fluid ? 0 : min(near + 1, l->far);
        s->begun[z * r->pitch] = (ushort)(SV_WALL_SURE - now);
        s->near[z * r->pitch] = (uchar)near;
        behind = tissue;
    }
    r->begun = SV_WALL_SURE - now;
}

/* After that. An open front, or no fluid at all: the surface belongs before the tissue. */
static void look_back(ray_t *r, const layers_t *s) {
    const bool in_front = !(r->touches && r->run_end < r->end);
    r->fluid = in_front ? 0 : r->run_end;
    r->fluid_end = in_front ? r->run : r->fluid_end;
    r->in_run = r->touches && r->run_end > r->run ? s->begun[(r->run_end - 1) * r->pitch] : 0;
}

/* What a ray pays in layer z but for the distance. `later`: probability that the fetus begins with tissue
 * whose fluid is behind the layer. */
static uint wrong_at(const sv_wall_layout *l, const ray_t *r, const layers_t *s, uint z, uint later) {
    const uint skin = z + l->skin;
    uint cost = share(l->left, later);
    if (z > 0 || !r->bare) cost += share(l->cut, s->begun[z * r->pitch]);
    if (r->touches && skin < r->run_end) cost += share(l->left, r->in_run - s->begun[skin * r->pitch]);
    if (z < r->fluid || z >= r->fluid_end) cost += share(l->other, SV_WALL_SURE - r->begun);
    return cost;
}

static uint away_at(const sv_wall_layout *l, uint near) {
    const uint far = (near * l->rate + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS;
    return min(far, (uint)SV_WALL_ONE);
}

/* Back to front: leaves the costs of the ray. */
static void walk_back(const sv_wall_layout *l, const ray_t *r, const layers_t *s, __global ushort *costs) {
    bool behind = false, fluid_behind = false;
    uint later = 0, run_end = r->begun, near = l->far;
    for (uint z = l->layers; z-- > 0;) {
        const bool tissue = is_tissue(r, z);
        const uint begun = s->begun[z * r->pitch], before = s->near[z * r->pitch];
        if (tissue && fluid_behind) later += run_end - begun;
        if (tissue && !behind) run_end = begun;
        fluid_behind = before == 0;
        behind = tissue;
        near = fluid_behind ? 0 : min(near + 1, l->far);
        const uint away = away_at(l, min(near, before));
        const uint cost = away + wrong_at(l, r, s, z, later);
        costs[z * r->pitch] = (ushort)(r->scanned ? cost : 0);
        s->near[z * r->pitch] = (uchar)(r->scanned ? away : 0);
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

/* One work group per row of rays: their costs, of these what is due to the distance from the fluid, and the
 * sum of the probabilities that the fetus is on them. `begun`: 16 bits a block, for the walk. */
__kernel void wall_items_costs(sv_wall_layout l, __global const uint *restrict info,
                               __global const uchar *restrict levels, __global const uchar *restrict bright,
                               __global const ushort *restrict rays, __global ushort *restrict begun,
                               __global ushort *restrict costs, __global uchar *restrict aways,
                               __global ulong *restrict fetus) {
    __local uint sum;
    const uint row = (uint)get_group_id(0);
    const uint columns = info[INFO_OUTCOME] == SV_WALL_SURFACE ? l.columns : 0;
    ray_t r = {.threshold = info[INFO_TISSUE], .chances = info + INFO_CHANCES, .bare = info[INFO_BARE] != 0};
    r.level_pitch = level_row(&l, 1, 0) - level_row(&l, 0, 0);
    r.pitch = block_row(&l, 1, 0);
    if (get_local_id(0) == 0) sum = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint x = (uint)get_local_id(0); x < columns; x += (uint)get_local_size(0)) {
        const size_t at = block_row(&l, 0, row) + x;
        const layers_t s = {begun + at, aways + at};
        r.levels = levels + level_row(&l, 0, row) + x;
        r.bright = bright + at;
        load_ray(&l, rays, x, row, &r);
        walk_forth(&l, &r, &s);
        look_back(&r, &s);
        if (r.scanned) atomic_add(&sum, r.begun);
        walk_back(&l, &r, &s, costs + at);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) fetus[row] = sum;
}
