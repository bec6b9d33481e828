/* SPDX-License-Identifier: MIT */
/*
 * Cost volume, the volume: what 16 rays pay for every label, summed over the rays of a cell, and the lateral
 * Gaussian along x. A cell is SV_COST_VALUES floats in a row: its labels, then its rays.
 *
 * What a ray comes to depends on what lies before and behind, so 16 rays are walked to and fro: tissue that
 * is too thin to part fluid, fluid intervals from the wall on, runs of tissue between them, costs. Masks are
 * -1 or 0.
 */
#ifndef SV_METHOD_COST_CLH
#include "cost/cost.clh"
#endif
#ifndef SV_COST_TILE_CLH
#include "cost/cost_tile.clh"
#endif

enum { FAR_AWAY = 1000 }; /* bins; further than any tau */

/* Whether a lane of a mask is set. PoCL's any() takes the lanes one by one. */
static bool any_lane(short16 mask) {
    const ulong4 lanes = as_ulong4(mask);
    const ulong2 both = lanes.lo | lanes.hi;
    return (both.x | both.y) != 0;
}

/* 16 rays: their bins in the tile, and what is known of them. */
typedef struct {
    __global const bin16_t *bins;
    short16 wall, back;
    short16 first;        /* bin at which the first interval begins; FAR_AWAY: there is none */
    short16 touching;     /* the first interval is only the wall, which something touches */
    short16 open0, open1; /* the longest interval: its first bin, and the first one behind it */
    float16 weight, none; /* of the vote; probability that no run is the fetus */
} rays_t;

/* What is kept of every bin of 16 rays while they are walked. */
typedef struct {
    /* Length of the fluid from here on; then: bin at which bone parts the run that starts here. */
    short16 fluid[SV_COST_LABELS];

    /* Brightest nearby, of the run so far; then: distance to the fluid behind. */
    short16 light[SV_COST_LABELS];

    /* Probability that the run that starts here, or whose fluid begins here, is the fetus; and of its part
     * behind the bone's front. */
    float16 fetus[SV_COST_LABELS], parted[SV_COST_LABELS];

    float16 cost[SV_COST_LABELS]; /* summed over the rays so far */
} bins16_t;

/* Length of the fluid that every bin begins or continues; scanned tissue thinner than `thin` counts as fluid.
 */
static void walk_fluid(const sv_cost_layout *l, const rays_t *r, short16 *fluid) {
    const short16 none = (short16)(0), thin = (short16)((short)l->thin);
    short16 whole = none, length = none; /* of the run of tissue that the bin is in; of the fluid */
    for (uint bin = l->labels; bin-- > 0;) {
        const short16 run = r->bins[bin].run;
        whole = max(whole, run) & (run > none);
        length = (length + (short)1) & (run >= none) & (whole < thin);
        fluid[bin] = length;
    }
}

/* The intervals: `fluid` becomes a mask, `light` the brightest nearby in the run of tissue so far. */
static void walk_intervals(const sv_cost_layout *l, rays_t *r, short16 *fluid, short16 *light) {
    const short16 none = (short16)(0);
    const short16 from = select((short16)(FAR_AWAY), max(r->wall - (short)l->solid, none), r->wall > none);
    short16 before = none, inside = none, most = none, longest = none;
    r->first = (short16)(FAR_AWAY);
    r->touching = r->open0 = r->open1 = none;
    for (uint bin = 0; bin < l->labels; bin++) {
        const short16 at = (short16)((short)bin), length = fluid[bin] & (at >= from);
        const short16 fresh = r->first == (short16)(FAR_AWAY);
        const short16 opens =
            (length > none) & (before == none) & (~fresh | (length >= (short16)((short)l->gap)));
        if (any_lane(opens & fresh)) {
            const short16 touches = opens & fresh & (at > r->wall + (short)l->contact);
            r->touching |= touches;
            r->first = select(select(r->first, at, opens & fresh), r->wall - (short)1, touches);
            r->open0 = select(r->open0, r->first, opens & fresh);
            r->open1 = select(r->open1, r->wall, touches);
            longest = select(longest, (short16)(1), touches);
        }
        const short16 candidate = (at + (short)l->solid < r->back) | (fresh & ~r->touching);
        const short16 longer = opens & candidate & (length > longest);
        r->open0 = select(r->open0, at, longer);
        r->open1 = select(r->open1, at + length, longer);
        longest = select(longest, length, longer);
        inside = (inside | opens) & (length > none);
        before = length;
        most = max(most, r->bins[bin].nearby) & ~inside & (at >= r->wall);
        fluid[bin] = inside;
        light[bin] = most;
    }
}

/* What a part of a run of tissue comes to. */
typedef struct {
    short16 tissue, own, nearby; /* bins of tissue; brightest of them on the ray and nearby */
} part_t;

static void part_add(part_t *p, short16 tissue, short16 own, short16 nearby) {
    p->tissue -= tissue;
    p->own = max(p->own, own & tissue);
    p->nearby = max(p->nearby, nearby & tissue);
}

static void part_keep(part_t *p, short16 mask) {
    p->tissue &= mask;
    p->own &= mask;
    p->nearby &= mask;
}

/* `other` where the mask is set. */
static void part_take(part_t *p, const part_t *other, short16 mask) {
    p->tissue = select(p->tissue, other->tissue, mask);
    p->own = select(p->own, other->own, mask);
    p->nearby = select(p->nearby, other->nearby, mask);
}

/* Runs of 16 rays on the way from their ends to their fronts. */
typedef struct {
    part_t all, front, rear; /* so far; before the foremost bone so far; from that on */
    short16 place;           /* of that bone; -1: none yet */
    float16 behind, next;    /* most probable run behind; the run whose fluid comes next */
} runs_t;

static void runs_add(runs_t *runs, short16 at, short16 tissue, short16 own, short16 nearby, short16 is_bone) {
    part_add(&runs->all, tissue, own, nearby);
    part_add(&runs->front, tissue, own, nearby);
    if (!any_lane(is_bone)) return;
    part_take(&runs->rear, &runs->all, is_bone);
    part_keep(&runs->front, ~is_bone);
    runs->place = select(runs->place, at, is_bone);
}

static float16 logistic(float16 x) {
    return 1.0f / (1.0f + exp(-x));
}

/* Probability that the parts are the fetus, 0 where `asked` is not set or the tissue is too thin. `behind`:
 * the largest farther back, which they join. */
static float16 judge_part(const sv_cost_layout *l, const part_t *p, float unit, short16 asked,
                          short16 touching, float16 *behind) {
    const float16 nearby = convert_float16(p->nearby) * unit, own = convert_float16(p->own) * unit;
    const float from = SV_COST_THICK_FROM * l->scale, full = SV_COST_THICK_FULL * l->scale;
    const float16 thick = clamp((convert_float16(p->tissue) - from) / (full - from), 0.0f, 1.0f);
    const float16 plain = SV_COST_NEARBY * nearby + SV_COST_OWN * own + SV_COST_THICK * thick + SV_COST_BIAS;
    const float16 evidence =
        select(plain, SV_COST_WALL * nearby + SV_COST_WALL_BIAS, convert_int16(touching));
    const int16 counts = convert_int16(asked & (p->tissue >= (short16)((short)l->thin)));
    const float16 fetus =
        select((float16)(0.0f), logistic(evidence - SV_COST_BEHIND_PENALTY * *behind), counts);
    *behind = max(*behind, select((float16)(0.0f), logistic(evidence), counts));
    return fetus;
}

/* At the fronts of runs: their probability, and that of their parts behind the bone. Gives back the
 * bins of those. */
static short16 runs_judge(const sv_cost_layout *l, rays_t *r, float unit, short16 at, short16 starts,
                          runs_t *runs, float16 *fetus, float16 *parted) {
    const short16 splits = starts & (runs->place >= at + (short)l->split);
    const short16 touches = r->touching & (at == r->wall);
    part_t one = runs->all;
    part_take(&one, &runs->front, splits);
    *parted = judge_part(l, &runs->rear, unit, splits, (short16)(0), &runs->behind);
    const float16 now = judge_part(l, &one, unit, starts, touches, &runs->behind);
    const int16 votes = convert_int16(touches & starts & (one.tissue >= (short16)((short)l->thin)));
    r->weight = select(r->weight, r->weight * (2.0f * now - 1.0f) * (2.0f * now - 1.0f), votes);
    r->none *= (1.0f - *parted) * (1.0f - now);
    runs->next = select(runs->next, now, convert_int16(starts));
    *fetus = select(*fetus, now, convert_int16(starts));
    return select((short16)(-1), runs->place, splits);
}

/* From the back: the probability that every run is the fetus. `unit`: 1 over the sum that tissue of mean
 * brightness has; `bone`: a sum from which on tissue is bone. What lies behind the last interval is the back
 * of the sac. */
static void walk_runs(const sv_cost_layout *l, rays_t *r, float unit, short bone, bins16_t *w) {
    const short16 none = (short16)(0);
    const part_t empty = {none, none, none};
    runs_t runs = {empty, empty, empty, (short16)(-1), (float16)(0.0f), (float16)(0.0f)};
    short16 most = none, inside = none, seen = none, away = (short16)(FAR_AWAY);
    r->none = (float16)(1.0f);
    for (uint bin = l->labels; bin-- > 0;) {
        const short16 at = (short16)((short)bin), run_end = inside;
        inside = w->fluid[bin] | (r->touching & (at == r->first));
        seen |= inside;
        const short16 before =
            bin > 0 ? w->fluid[bin - 1] | (r->touching & (at == r->first + (short)1)) : none;
        const short16 in_run = seen & ~inside & (at > r->first);
        const short16 starts = in_run & before, begins = inside & ~before;
        most = select(most, w->light[bin], run_end);
        away = (away + (short)1) & ~inside;
        w->light[bin] = away;

        const short16 nearby = r->bins[bin].nearby, own = r->bins[bin].own, tissue = in_run & (nearby > none);
        const short16 is_bone = tissue & (most >= (short16)(bone)) &
                                (min(most - nearby, (short16)(1000)) * (short)SV_COST_FRONT <=
                                 nearby * (short)(10 - SV_COST_FRONT));
        runs_add(&runs, at, tissue, own, nearby, is_bone);
        w->fetus[bin] = select((float16)(0.0f), runs.next, convert_int16(begins));
        w->parted[bin] = (float16)(0.0f);
        if (any_lane(starts))
            w->fluid[bin] = runs_judge(l, r, unit, at, starts, &runs, &w->fetus[bin], &w->parted[bin]);
        runs.next = select(runs.next, (float16)(0.0f), convert_int16(begins));
        part_keep(&runs.all, in_run & ~starts);
        part_keep(&runs.front, in_run & ~starts);
        runs.place |= ~(in_run & ~starts); /* -1 */
    }
}

/* Adds the costs of 16 rays. */
static void walk_costs(const sv_cost_layout *l, const rays_t *r, bins16_t *w) {
    const float16 per_bin = (float16)(1.0f / (SV_COST_TAU * l->scale));
    const int16 is_open = convert_int16(r->first != (short16)(FAR_AWAY));
    const float16 other = select((float16)(0.0f), SV_COST_OTHER * r->none, is_open);
    short16 from = (short16)(FAR_AWAY), inside = (short16)(0), place = (short16)(-1);
    float16 none = (float16)(1.0f), cut = (float16)(0.0f), passed = cut, parted = cut;
    for (uint bin = 0; bin < l->labels; bin++) {
        const short16 at = (short16)((short)bin), before = inside;
        inside = w->light[bin] == (short16)(0);
        const int16 starts = convert_int16(before & ~inside), begins = convert_int16(inside & ~before);
        const float16 here = none * w->fetus[bin];
        passed += select((float16)(0.0f), here, begins);
        cut += select((float16)(0.0f), here, starts);
        none -= select((float16)(0.0f), here, starts);
        place = select(place, w->fluid[bin], before & ~inside);
        parted = select(parted, w->parted[bin], starts);
        const short16 bone = place == at;
        if (any_lane(bone)) {
            const float16 rear = select((float16)(0.0f), none * parted, convert_int16(bone));
            passed += rear;
            cut += rear;
            none -= rear;
        }
        from = (from + (short)1) & ~inside;
        const float16 away = convert_float16(min(from, w->light[bin])) - 0.5f;
        float16 cost = clamp(away * per_bin, 0.0f, 1.0f);
        cost += SV_COST_CUT * cut + SV_COST_LEFT * (1.0f - r->none - passed);
        cost += select(other, (float16)(0.0f), convert_int16((at >= r->open0) & (at < r->open1)));
        w->cost[bin] += r->weight * cost;
    }
}

/* Adds the costs of 16 rays that stand in the tile. Returns which of them have a fluid interval: without one,
 * every label costs 1. */
static short16 add_costs(const sv_cost_layout *l, rays_t *r, float unit, short bone, bins16_t *w) {
    walk_fluid(l, r, w->fluid);
    walk_intervals(l, r, w->fluid, w->light);
    const short16 opens = r->first != (short16)(FAR_AWAY);
    if (any_lane(opens)) {
        walk_runs(l, r, unit, bone, w);
        walk_costs(l, r, w);
    } else
        for (uint bin = 0; bin < l->labels; bin++) w->cost[bin] += r->weight;
    return opens;
}

/* The wall or back of the cell that each of 16 rays is in. */
static short16 cells_of(const sv_cost_layout *l, __global const uchar *row, uint x) {
    short16 lanes;
    for (uint i = 0; i < SV_LANES; i++) ((short *)&lanes)[i] = row[min((x + i) / l->block, l->cells_x - 1)];
    return lanes;
}

/* Hands lane i of `value` to the cell of ray x + i. */
static void to_cells(const sv_cost_layout *l, __global float *cells, uint slot, uint x, float16 value) {
    const uint count = min((uint)SV_LANES, l->columns - x);
    const float *lanes = (const float *)&value;
    for (uint i = 0; i < count; i++) cells[(x + i) / l->block * SV_COST_VALUES + slot] += lanes[i];
}

/* Lanes of 16 labels become labels of 16 lanes: four times, the first half of the vectors is shuffled into
 * the other. */
static void transpose(const float16 *from, float16 *to) {
    float16 here[SV_LANES], next[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) here[i] = from[i];
    for (uint turn = 0; turn < 4; turn++) {
        for (uint i = 0; i < SV_LANES / 2; i++) {
            next[2 * i].even = here[i].lo;
            next[2 * i].odd = here[i + SV_LANES / 2].lo;
            next[2 * i + 1].even = here[i].hi;
            next[2 * i + 1].odd = here[i + SV_LANES / 2].hi;
        }
        for (uint i = 0; i < SV_LANES; i++) here[i] = next[i];
    }
    for (uint i = 0; i < SV_LANES; i++) to[i] = here[i];
}

/* Hands the costs of 16 rays to their cells. */
static void costs_to_cells(const sv_cost_layout *l, __global float *cells, uint x, const float16 *cost) {
    const uint count = min((uint)SV_LANES, l->columns - x);
    float16 rays[SV_LANES];
    for (uint bin = 0; bin < l->labels; bin += SV_LANES) {
        transpose(cost + bin, rays);
        for (uint i = 0; i < count; i++)
            *(__global float16 *)(cells + (x + i) / l->block * SV_COST_VALUES + bin) += rays[i];
    }
}

static uint count_lanes(short16 mask, uint lanes) {
    const short *each = (const short *)&mask;
    uint count = 0;
    for (uint i = 0; i < lanes; i++) count -= (uint)(int)each[i];
    return count;
}

/* What the rows of cells of a work item have in common. */
typedef struct {
    __global const uchar *walls, *backs;
    __global bin16_t *tile;
    __global float *volume;
    float unit; /* see walk_runs */
    short bone;
    bins16_t w;
} gather_t;

/* A row of cells. `counts`: its scanned rays, and those with a fluid interval. */
static void gather_row(const sv_cost_layout *l, const tile_source_t *s, gather_t *g, uint cell_row,
                       __global uint *counts) {
    __global float *cells = cell_at(g->volume, l, 0, cell_row);
    __global const uchar *wall = g->walls + cell_row * l->cells_x, *back = g->backs + cell_row * l->cells_x;
    uint scanned_rays = 0, open_rays = 0;
    for (size_t i = 0; i < (size_t)l->cells_x * SV_COST_VALUES; i++) cells[i] = 0.0f;
    for (uint x = 0; x < l->columns; x += SV_LANES) {
        const uint lanes = min((uint)SV_LANES, l->columns - x);
        float16 weight = (float16)(0.0f), open = weight;
        short16 scanned[MOST_BLOCK];
        rays_t r;
        r.wall = cells_of(l, wall, x);
        r.back = cells_of(l, back, x);
        const bool walled = any_lane(r.wall > (short16)(0));
        if (walled)
            fill_tile(l, s, x, g->tile, scanned);
        else
            find_scanned(l, s, x, scanned);
        for (uint bin = 0; walled && bin < l->labels; bin++) g->w.cost[bin] = (float16)(0.0f);
        for (uint k = 0; k < s->rows; k++) {
            r.weight = select((float16)(0.0f), (float16)(1.0f), convert_int16(scanned[k]));
            scanned_rays += count_lanes(scanned[k], lanes);
            if (walled && any_lane(scanned[k])) {
                r.bins = g->tile + k * l->labels;
                const short16 opens = add_costs(l, &r, g->unit, g->bone, &g->w);
                open += select((float16)(0.0f), r.weight, convert_int16(opens));
                open_rays += count_lanes(scanned[k] & opens, lanes);
            }
            weight += r.weight;
        }
        for (uint bin = 0; !walled && bin < l->labels; bin++) g->w.cost[bin] = weight;
        costs_to_cells(l, cells, x, g->w.cost);
        to_cells(l, cells, SV_COST_WEIGHT, x, weight);
        to_cells(l, cells, SV_COST_OPEN, x, open);
    }
    counts[0] = scanned_rays;
    counts[1] = open_rays;
}

static bool has_wall(__global const uchar *walls, uint count) {
    for (uint i = 0; i < count; i++)
        if (walls[i] > 0) return true;
    return false;
}

/* One work item per band of `band` rows of cells. `walls`: wall, then back of every cell. `sums` and
 * `brightest`: room for a ring of rows of rays, `tiles`: for a tile, for every work item. `counts`: scanned
 * rays and rays with a fluid interval, per row of cells. */
__kernel void cost_gather(sv_cost_layout l, uint band, __global const uchar *restrict bins,
                          __global ushort *sums, __global ushort *brightest,
                          __global const uchar *restrict walls, __global const uint *restrict info,
                          __global bin16_t *restrict tiles, __global float *restrict volume,
                          __global uint *restrict counts) {
    const uint item = (uint)get_global_id(0), end = min((item + 1) * band, l.cells_y);
    const size_t first = item * bins_at(&l, sv_cost_ring_rows(&l), 0);
    const ring_t ring = {sums + first, brightest + first};
    const uint bright = info[SV_COST_INFO_BRIGHT];
    gather_t g;
    g.walls = walls;
    g.backs = walls + (size_t)l.cells_x * l.cells_y;
    g.tile = tiles + (size_t)item * l.block * l.labels;
    g.volume = volume;
    g.unit = 1.0f / ((float)SV_COST_NEIGHBOURS * (float)bright);
    g.bone = (short)((SV_COST_BONE * SV_COST_NEIGHBOURS * bright + 1) / 2);
    for (uint bin = 0; bin < SV_COST_LABELS; bin++) g.w.cost[bin] = (float16)(0.0f);
    uint made = 0; /* rows of rays */
    for (uint cell_row = item * band; cell_row < end; cell_row++) {
        const uint y0 = cell_row * l.block;
        if (has_wall(walls + cell_row * l.cells_x, l.cells_x)) {
            const uint y1 = min(y0 + l.block + l.lateral, l.rows);
            make_rows(&l, bins, max(made, y0 - min(y0, l.lateral)), y1, &ring);
            made = y1;
        }
        const tile_source_t source = tile_source(&l, bins, &ring, y0, info[SV_COST_INFO_LEVEL]);
        gather_row(&l, &source, &g, cell_row, counts + 2 * cell_row);
    }
}

/* One work item: whether the frame has a surface. */
__kernel void cost_decide(sv_cost_layout l, __global const uint *restrict counts,
                          __global uint *restrict info, __global uint *restrict record) {
    uint scanned = 0, open = 0;
    for (uint row = 0; row < l.cells_y; row++) {
        scanned += counts[2 * row];
        open += counts[2 * row + 1];
    }
    const bool wanted = surface_wanted(record) && open > 0 && open * SV_COST_EVIDENCE >= scanned;
    info[SV_COST_INFO_RAYS] = scanned;
    info[SV_COST_INFO_OPEN] = open;
    info[SV_COST_INFO_WANTED] = wanted;
    record[SV_REC_PASSES] = wanted;
    record[SV_REC_UNFILLED] = wanted ? 0 : record[SV_REC_RAYS];
    record[SV_REC_OUTCOME] = wanted ? SV_OUTCOME_OK : SV_OUTCOME_NO_SURFACE;
}

/* One work item per row of cells: the Gaussian along x. weight.s0 .. s4: at 0 .. 4 cells. */
__kernel void cost_blur(sv_cost_layout l, float8 weight, __global const uint *restrict info,
                        __global float *restrict volume, __global float *restrict blurred) {
    const uint y = (uint)get_global_id(0);
    if (!info[SV_COST_INFO_WANTED]) return;
    float weights[8];
    vstore8(weight, 0, weights);
    for (int x = 0; x < (int)l.cells_x; x++) {
        const int x0 = max(x - SV_COST_REACH, 0), x1 = min(x + SV_COST_REACH, (int)l.cells_x - 1);
        for (uint v = 0; v < SV_COST_VALUES; v += SV_LANES) {
            float16 sum = (float16)(0.0f);
            for (int u = x0; u <= x1; u++)
                sum += weights[abs(u - x)] * vload16(0, cell_at(volume, &l, (uint)u, y) + v);
            *(__global float16 *)(cell_at(blurred, &l, (uint)x, y) + v) = sum;
        }
    }
}
