/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, costs: what every ray pays for being clipped at every label, and the means of that over
 * the rays of a cell.
 *
 * 16 rays are walked front to back, which tells where the fetus begins and how far the fluid in front is, and
 * back to front, which tells how far the fluid behind is and what the fluid leaves to the tissue behind it.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* 16 rays, and what is known of them. */
typedef struct {
    __global const uchar16 *tissue, *bright;
    size_t plane;
    __global const uint *chances;
    short16 first, end, run, run_end; /* scanned slices, the first tissue */
    short16 touches;                  /* that begins where the scan does */
    short16 fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    ushort16 begun, in_run;           /* probability of a fetus; of one that begins in the first tissue */
} rays_t;

/* What is kept of every slice of 16 rays while they are walked. */
typedef struct {
    __global ushort16 *begun; /* probability that the fetus has begun */
    __global uchar16 *near;   /* distance to the fluid in front */
} slices_t;

/* Shares of a value, a number or one a ray, rounded half up. */
static uint16 share(uint16 value, ushort16 chance) {
    return (value * convert_uint16(chance) + SV_WALL_SURE / 2u) / (uint)SV_WALL_SURE;
}

/* Probabilities of brightnesses; the first tissue of a ray has its own. */
static ushort16 chances_of(const rays_t *r, uchar16 bright, short16 at_run) {
    const uchar *level = (const uchar *)&bright;
    const short *in_run = (const short *)&at_run;
    ushort16 chance;
    for (uint i = 0; i < SV_LANES; i++)
        ((ushort *)&chance)[i] = (ushort)r->chances[level[i] + (in_run[i] ? 0u : 256u)];
    return chance;
}

static void find_fluid(const sv_wall_layout *l, rays_t *r, short16 at, short16 fluid, short16 *found,
                       short16 *open) {
    const short16 fresh = fluid & ~*found;
    r->fluid = select(r->fluid, at + (short)(1 - (int)l->gap), fresh);
    *found |= fresh;
    *open |= fresh;
}

/* Front to back. */
static void walk_forth(const sv_wall_layout *l, rays_t *r, const slices_t *s) {
    const uchar16 gap = (uchar16)((uchar)l->gap), far = (uchar16)((uchar)l->far);
    ushort16 before = (ushort16)(SV_WALL_SURE), now = before;
    uchar16 most = (uchar16)(0), behind = most, run = most, near = far;
    short16 found = (short16)(0), open = found;
    r->fluid = (short16)(0);
    r->fluid_end = (short16)((short)l->slices);
    for (uint z = 0; z < l->slices; z++) {
        const short16 at = (short16)((short)z);
        const uchar16 tissue = r->tissue[z * r->plane], bright = r->bright[z * r->plane] & tissue;
        const uchar16 fluid = bytes_of((r->first <= at) & (r->end > at)) & ~tissue;
        const uchar16 asks = tissue & (as_uchar16(bright > most) | ~behind);
        most = max(most & tissue, bright);
        if (some_bytes(asks)) {
            const ushort16 chance = chances_of(r, most, r->touches & (r->run_end > at));
            now = select(now, before - convert_ushort16(share(convert_uint16(before), chance)),
                         as_ushort16(words_of(tissue)));
        }
        before = select(now, before, as_ushort16(words_of(tissue)));
        behind = tissue;
        s->begun[z] = (ushort16)(SV_WALL_SURE)-now;
        run = longer(run) & fluid;
        const uchar16 wide = as_uchar16(run >= gap);
        near = min(near + (uchar16)(1), far) & ~wide;
        s->near[z] = near;
        if (some_bytes(wide & ~bytes_of(found))) find_fluid(l, r, at, words_of(wide), &found, &open);
        if (some_words(open & ~words_of(fluid))) {
            r->fluid_end = select(r->fluid_end, at, open & ~words_of(fluid));
            open &= words_of(fluid);
        }
    }
    const short16 in_front = ~(r->touches & found);
    r->fluid &= ~in_front;
    r->fluid_end = select(r->fluid_end, r->run, in_front);
    r->begun = (ushort16)(SV_WALL_SURE)-now;
}

/* Probability that the fetus begins in the first tissue, where that begins with the scan. */
static void find_in_run(rays_t *r, const slices_t *s) {
    const short16 has_run = r->touches & (r->run_end > r->run);
    const short *end = (const short *)&r->run_end, *some = (const short *)&has_run;
    for (uint i = 0; i < SV_LANES; i++)
        ((ushort *)&r->in_run)[i] =
            some[i] ? ((__global const ushort *)(s->begun + (end[i] - 1)))[i] : (ushort)0;
}

/* Adds what 16 rays pay for label `z / step`. `near`: distance to the fluid; `later`: probability that the
 * fetus begins with tissue whose fluid is behind the label. */
static void add_costs(const sv_wall_layout *l, const rays_t *r, const slices_t *s, uint z, uchar16 near,
                      ushort16 later, uint weight, __global uint16 *away, __global uint16 *wrong) {
    const short16 at = (short16)((short)z);
    const uint16 scanned = as_uint16(convert_int16(r->end > r->first));
    uint16 cost = share((uint16)(l->cut), s->begun[z]) + share((uint16)(l->left), later);
    const uint skin = z + l->skin;
    if (skin < l->slices) {
        const short16 over = r->touches & (r->run_end > (short16)((short)skin));
        if (some_words(over))
            cost += share((uint16)(l->left), (r->in_run - s->begun[skin]) & as_ushort16(over));
    }
    const short16 other = (at < r->fluid) | (at >= r->fluid_end);
    if (some_words(other))
        cost += share((uint16)(l->other), ((ushort16)(SV_WALL_SURE)-r->begun) & as_ushort16(other));
    uint16 far = convert_uint16(near) * l->rate;
    far = min((far + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS, (uint16)(SV_WALL_ONE));
    *away += (far & scanned) * weight;
    *wrong += (cost & scanned) * weight;
}

/* Back to front: adds the costs of 16 rays, `weight` times. */
static void walk_back_costs(const sv_wall_layout *l, const rays_t *r, const slices_t *s, uint weight,
                            __global uint16 *away, __global uint16 *wrong) {
    const uchar16 far = (uchar16)((uchar)l->far);
    uchar16 wide = (uchar16)(0), behind = wide, near = far;
    ushort16 later = (ushort16)(0), run_end = r->begun;
    uint label = l->labels, next = (l->labels - 1) * l->step; /* slice of the label to come */
    for (uint z = l->slices; z-- > 0;) {
        const short16 at = (short16)((short)z);
        const uchar16 tissue = r->tissue[z * r->plane], in_front = bytes_of(r->first > at);
        const uchar16 fluid = bytes_of((r->first <= at) & (r->end > at)) & ~tissue;
        const ushort16 begun = s->begun[z];
        const uchar16 ends = wide & tissue, enters = tissue & ~behind;
        later += (run_end - begun) & as_ushort16(words_of(ends));
        run_end = select(run_end, begun, as_ushort16(words_of(enters)));
        wide = (fluid & (as_uchar16(s->near[z] == (uchar16)(0)) | wide)) | (in_front & wide);
        behind = tissue;
        near = min(near + (uchar16)(1), far) & ~wide;
        if (z != next) continue;
        label--;
        next -= l->step;
        add_costs(l, r, s, z, min(near, s->near[z]), later, weight, away + label, wrong + label);
    }
}

/* The cells that pixel i of `pixels` belongs to, of `cells` in a row: the first, and their number. */
static uint owners(uint i, uint pixels, uint cells, uint *first) {
    const uint at = (2 * i + 1) * cells, width = 2 * pixels;
    *first = at / width;
    if (at % width != 0) return 1;
    (*first)--;
    return 2;
}

/* Hands the costs of 16 columns to their cells; a column between two cells counts half in each. */
static void to_cells(const sv_wall_layout *l, uint x0, const ushort *counts, __global const uint16 *away,
                     __global const uint16 *wrong, __global uint *cell_away, __global uint *cell_wrong,
                     __global uint *cell_rays) {
    const uint padded = padded_labels_of(l);
    for (uint i = 0; i < SV_LANES && x0 + i < l->width; i++) {
        uint cell = 0;
        const uint number = owners(x0 + i, l->width, l->cells_x, &cell), weight = 2 / number;
        for (uint u = cell; u < cell + number; u++) {
            cell_rays[u] += weight * counts[i];
            for (uint k = 0; k < l->labels; k++) {
                cell_away[u * padded + k] += weight * ((__global const uint *)(away + k))[i];
                cell_wrong[u * padded + k] += weight * ((__global const uint *)(wrong + k))[i];
            }
        }
    }
}

/* Sums of quarters to means in units of 1 / SV_WALL_CELL_ONE, rounded half up. Exact, whatever the rounding
 * of the float32 estimate. */
static uint16 mean_cost(uint16 sum, uint rays) {
    const uint16 scaled = sum * (uint)(SV_WALL_CELL_ONE / SV_WALL_ONE) + rays / 2;
    uint16 mean = convert_uint16(convert_float16(scaled) * (1.0f / (float)rays));
    const int16 rest = as_int16(scaled - mean * rays);
    mean -= as_uint16(rest < (int16)(0)) & 1u;
    return select(mean + 1u, mean, (rest < (int16)((int)rays)) | (rest < (int16)(0)));
}

static void load_rays(const sv_wall_layout *l, __global const uchar16 *tissue, __global const uchar16 *bright,
                      __global ushort16 *rays, uint x, uint y, rays_t *r) {
    const uint vectors = padded_width_of(l) / SV_LANES;
    r->plane = (size_t)vectors * l->height;
    r->tissue = tissue + (size_t)y * vectors + x;
    r->bright = bright + (size_t)y * vectors + x;
    r->first = as_short16(ray_row(rays, l, RAY_FIRST, y)[x]);
    r->end = as_short16(ray_row(rays, l, RAY_END, y)[x]);
    r->run = as_short16(ray_row(rays, l, RAY_RUN, y)[x]);
    r->run_end = as_short16(ray_row(rays, l, RAY_RUN_END, y)[x]);
    r->touches = (r->end > r->first) & (r->run - r->first < (short16)((short)l->gap));
}

/* What a row of cells keeps while its rays are walked, in vectors of 16 bits: see wall_scratch_vectors. */
typedef struct {
    slices_t slices;
    __global uint16 *away, *wrong;                     /* of 16 columns, a label each */
    __global uint *cell_away, *cell_wrong, *cell_rays; /* sums */
} scratch_t;

static scratch_t scratch_of(const sv_wall_layout *l, __global uint16 *at) {
    const size_t cells = (size_t)l->cells_x * (padded_labels_of(l) / SV_LANES);
    scratch_t s;
    s.away = at;
    s.wrong = s.away + l->labels;
    s.cell_away = (__global uint *)(s.wrong + l->labels);
    s.cell_wrong = s.cell_away + cells * SV_LANES;
    s.cell_rays = s.cell_wrong + cells * SV_LANES;
    s.slices.begun = (__global ushort16 *)(s.cell_rays + (l->cells_x + SV_LANES - 1) / SV_LANES * SV_LANES);
    s.slices.near = (__global uchar16 *)(s.slices.begun + l->slices);
    return s;
}

static ulong sum_lanes(ushort16 values) {
    const ushort *lanes = (const ushort *)&values;
    ulong sum = 0;
    for (uint i = 0; i < SV_LANES; i++) sum += lanes[i];
    return sum;
}

/* The costs of the rays of one column of vectors, of all rows of a row of cells. Gives back the sum over its
 * rays of the probability that the fetus is on them; a row between two cells counts with the first. */
static ulong walk_column(const sv_wall_layout *l, const scratch_t *s, __global const uchar16 *tissue,
                         __global const uchar16 *bright, __global ushort16 *rays,
                         __global const uint *chances, uint x, uint cell_row) {
    ushort16 counts = (ushort16)(0);
    ulong fetus = 0;
    for (uint k = 0; k < l->labels; k++) s->away[k] = s->wrong[k] = (uint16)(0);
    for (uint y = cell_row * l->height / l->cells_y; y < l->height; y++) {
        uint cell = 0;
        const uint number = owners(y, l->height, l->cells_y, &cell);
        if (cell > cell_row) break;
        if (cell + number <= cell_row) continue;
        rays_t r;
        load_rays(l, tissue, bright, rays, x, y, &r);
        r.chances = chances;
        if (!some_words(r.end > r.first)) continue;
        walk_forth(l, &r, &s->slices);
        find_in_run(&r, &s->slices);
        if (cell == cell_row) fetus += sum_lanes(r.begun & as_ushort16(r.end > r.first));
        walk_back_costs(l, &r, &s->slices, 2 / number, s->away, s->wrong);
        counts += as_ushort16(r.end > r.first) & (ushort)(2 / number);
    }
    to_cells(l, x * SV_LANES, (const ushort *)&counts, s->away, s->wrong, s->cell_away, s->cell_wrong,
             s->cell_rays);
    return fetus;
}

/* One work item per row of cells: their costs, and of these what is due to the distance from the fluid.
 * `scratch`: scratch_vectors a row of cells. */
__kernel void wall_costs(sv_wall_layout l, uint scratch_vectors, __global const uint *restrict info,
                         __global const uchar16 *restrict tissue, __global const uchar16 *restrict bright,
                         __global ushort16 *restrict rays, __global uint16 *restrict scratch,
                         __global uint16 *restrict costs, __global uint16 *restrict aways,
                         __global ulong *restrict fetus) {
    const uint row = (uint)get_global_id(0), vectors = padded_width_of(&l) / SV_LANES;
    const uint label_vectors = padded_labels_of(&l) / SV_LANES;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const scratch_t s = scratch_of(&l, scratch + (size_t)row * scratch_vectors);
    for (size_t i = 0; i < (size_t)l.cells_x * label_vectors * SV_LANES; i++)
        s.cell_away[i] = s.cell_wrong[i] = 0;
    for (uint i = 0; i < l.cells_x; i++) s.cell_rays[i] = 0;
    fetus[row] = 0;
    for (uint x = 0; x < vectors; x++)
        fetus[row] += walk_column(&l, &s, tissue, bright, rays, info + INFO_CHANCES, x, row);
    costs += (size_t)row * l.cells_x * label_vectors;
    aways += (size_t)row * l.cells_x * label_vectors;
    for (uint cell = 0; cell < l.cells_x; cell++) {
        const uint all = s.cell_rays[cell];
        for (uint k = 0; k < label_vectors; k++) {
            const size_t at = (size_t)cell * label_vectors + k;
            const uint16 away =
                all ? mean_cost(((__global const uint16 *)s.cell_away)[at], all) : (uint16)(0);
            const uint16 wrong =
                all ? mean_cost(((__global const uint16 *)s.cell_wrong)[at], all) : (uint16)(0);
            costs[at] = away + wrong;
            aways[at] = away;
        }
    }
}
