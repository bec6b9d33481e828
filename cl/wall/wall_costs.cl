/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, costs: what every ray pays for being clipped at every label, and the means of that over
 * the rays of a cell.
 *
 * LANES rays are walked front to back, which tells where the fetus begins and how far the fluid in front is,
 * and back to front, which tells how far the fluid behind is and what the fluid leaves to the tissue behind
 * it.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* LANES rays, and what is known of them. */
typedef struct {
    __global const u8l *tissue, *bright;
    size_t plane;
    __global const uint *chances;
    i16l first, end, run, run_end; /* scanned slices, the first tissue */
    i16l touches;                  /* that begins where the scan does */
    i16l fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    u16l begun, in_run;            /* probability of a fetus; of one that begins in the first tissue */
} rays_t;

/* What is kept of every slice of LANES rays while they are walked. */
typedef struct {
    __global u16l *begun; /* probability that the fetus has begun */
    __global u8l *near;   /* distance to the fluid in front */
} slices_t;

/* Shares of a value, a number or one a ray, rounded half up. */
static u32l share(u32l value, u16l chance) {
    return (value * TO_U32(chance) + SV_WALL_SURE / 2u) / (uint)SV_WALL_SURE;
}

/* Probabilities of brightnesses; the first tissue of a ray has its own. */
static u16l chances_of(const rays_t *r, u8l bright, i16l at_run) {
    const uchar *level = (const uchar *)&bright;
    const short *in_run = (const short *)&at_run;
    u16l chance;
    for (uint i = 0; i < LANES; i++)
        ((ushort *)&chance)[i] = (ushort)r->chances[level[i] + (in_run[i] ? 0u : 256u)];
    return chance;
}

static void find_fluid(const sv_wall_layout *l, rays_t *r, i16l at, i16l fluid, i16l *found, i16l *open) {
    const i16l fresh = fluid & ~*found;
    r->fluid = PICK(r->fluid, at + (short)(1 - (int)l->gap), fresh);
    *found |= fresh;
    *open |= fresh;
}

/* Front to back. */
static void walk_forth(const sv_wall_layout *l, rays_t *r, const slices_t *s) {
    const u8l gap = (u8l)((uchar)l->gap), far = (u8l)((uchar)l->far);
    u16l before = (u16l)(SV_WALL_SURE), now = before;
    u8l most = (u8l)(0), behind = most, run = most, near = far;
    i16l found = (i16l)(0), open = found;
    r->fluid = (i16l)(0);
    r->fluid_end = (i16l)((short)l->slices);
    for (uint z = 0; z < l->slices; z++) {
        const i16l at = (i16l)((short)z);
        const u8l tissue = r->tissue[z * r->plane], bright = r->bright[z * r->plane] & tissue;
        const u8l fluid = bytes_of((r->first <= at) & (r->end > at)) & ~tissue;
        const u8l asks = tissue & (AS_U8(bright > most) | ~behind);
        most &= tissue;
        most = MOST(most, bright);
        if (some_bytes(asks)) {
            const u16l chance = chances_of(r, most, r->touches & (r->run_end > at));
            now = PICK(now, before - TO_U16(share(TO_U32(before), chance)), AS_U16(words_of(tissue)));
        }
        before = PICK(now, before, AS_U16(words_of(tissue)));
        behind = tissue;
        s->begun[z] = (u16l)(SV_WALL_SURE)-now;
        run = longer(run) & fluid;
        const u8l wide = AS_U8(run >= gap);
        near = LEAST(near + (u8l)(1), far) & ~wide;
        s->near[z] = near;
        if (some_bytes(wide & ~bytes_of(found))) find_fluid(l, r, at, words_of(wide), &found, &open);
        if (some_words(open & ~words_of(fluid))) {
            r->fluid_end = PICK(r->fluid_end, at, open & ~words_of(fluid));
            open &= words_of(fluid);
        }
    }
    const i16l in_front = ~(r->touches & found);
    r->fluid &= ~in_front;
    r->fluid_end = PICK(r->fluid_end, r->run, in_front);
    r->begun = (u16l)(SV_WALL_SURE)-now;
}

/* Probability that the fetus begins in the first tissue, where that begins with the scan. */
static void find_in_run(rays_t *r, const slices_t *s) {
    const i16l has_run = r->touches & (r->run_end > r->run);
    const short *end = (const short *)&r->run_end, *some = (const short *)&has_run;
    for (uint i = 0; i < LANES; i++)
        ((ushort *)&r->in_run)[i] =
            some[i] ? ((__global const ushort *)(s->begun + (end[i] - 1)))[i] : (ushort)0;
}

/* Adds what LANES rays pay for label `z / step`. `near`: distance to the fluid; `later`: probability that the
 * fetus begins with tissue whose fluid is behind the label. */
static void add_costs(const sv_wall_layout *l, const rays_t *r, const slices_t *s, uint z, u8l near,
                      u16l later, uint weight, __global u32l *away, __global u32l *wrong) {
    const i16l at = (i16l)((short)z);
    const u32l scanned = AS_U32(TO_I32(r->end > r->first));
    u32l cost = share((u32l)(l->cut), s->begun[z]) + share((u32l)(l->left), later);
    const uint skin = z + l->skin;
    if (skin < l->slices) {
        const i16l over = r->touches & (r->run_end > (i16l)((short)skin));
        if (some_words(over)) cost += share((u32l)(l->left), (r->in_run - s->begun[skin]) & AS_U16(over));
    }
    const i16l other = (at < r->fluid) | (at >= r->fluid_end);
    if (some_words(other)) cost += share((u32l)(l->other), ((u16l)(SV_WALL_SURE)-r->begun) & AS_U16(other));
    u32l far = TO_U32(near) * l->rate;
    far = (far + (1u << (SV_WALL_RATE_BITS - 1))) >> SV_WALL_RATE_BITS;
    far = LEAST(far, (u32l)(SV_WALL_ONE));
    *away += (far & scanned) * weight;
    *wrong += (cost & scanned) * weight;
}

/* Back to front: adds the costs of LANES rays, `weight` times. */
static void walk_back_costs(const sv_wall_layout *l, const rays_t *r, const slices_t *s, uint weight,
                            __global u32l *away, __global u32l *wrong) {
    const u8l far = (u8l)((uchar)l->far);
    u8l wide = (u8l)(0), behind = wide, near = far;
    u16l later = (u16l)(0), run_end = r->begun;
    uint label = l->labels, next = (l->labels - 1) * l->step; /* slice of the label to come */
    for (uint z = l->slices; z-- > 0;) {
        const i16l at = (i16l)((short)z);
        const u8l tissue = r->tissue[z * r->plane], in_front = bytes_of(r->first > at);
        const u8l fluid = bytes_of((r->first <= at) & (r->end > at)) & ~tissue;
        const u16l begun = s->begun[z];
        const u8l ends = wide & tissue, enters = tissue & ~behind;
        later += (run_end - begun) & AS_U16(words_of(ends));
        run_end = PICK(run_end, begun, AS_U16(words_of(enters)));
        wide = (fluid & (AS_U8(s->near[z] == (u8l)(0)) | wide)) | (in_front & wide);
        behind = tissue;
        near = LEAST(near + (u8l)(1), far) & ~wide;
        if (z != next) continue;
        label--;
        next -= l->step;
        add_costs(l, r, s, z, LEAST(near, s->near[z]), later, weight, away + label, wrong + label);
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

/* Hands the costs of LANES columns to their cells; a column between two cells counts half in each. */
static void to_cells(const sv_wall_layout *l, uint x0, const ushort *counts, __global const u32l *away,
                     __global const u32l *wrong, __global uint *cell_away, __global uint *cell_wrong,
                     __global uint *cell_rays) {
    const uint padded = padded_labels_of(l);
    for (uint i = 0; i < LANES && x0 + i < l->width; i++) {
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

static void load_rays(const sv_wall_layout *l, __global const u8l *tissue, __global const u8l *bright,
                      __global ushort *rays, uint x, uint y, rays_t *r) {
    const uint vectors = padded_width_of(l) / LANES;
    r->plane = (size_t)vectors * l->height;
    r->tissue = tissue + (size_t)y * vectors + x;
    r->bright = bright + (size_t)y * vectors + x;
    r->first = AS_I16(ray_row(rays, l, RAY_FIRST, y)[x]);
    r->end = AS_I16(ray_row(rays, l, RAY_END, y)[x]);
    r->run = AS_I16(ray_row(rays, l, RAY_RUN, y)[x]);
    r->run_end = AS_I16(ray_row(rays, l, RAY_RUN_END, y)[x]);
    r->touches = (r->end > r->first) & (r->run - r->first < (i16l)((short)l->gap));
}

/* What a row of cells keeps while its rays are walked, in vectors of 16 bits: see wall_scratch_vectors. */
typedef struct {
    slices_t slices;
    __global u32l *away, *wrong;                       /* of LANES columns, a label each */
    __global uint *cell_away, *cell_wrong, *cell_rays; /* sums */
} scratch_t;

static scratch_t scratch_of(const sv_wall_layout *l, __global uint16 *at) {
    const size_t cells = (size_t)l->cells_x * (padded_labels_of(l) / SV_LANES);
    scratch_t s;
    s.away = (__global u32l *)at;
    s.wrong = s.away + l->labels;
    s.cell_away = (__global uint *)(s.wrong + l->labels);
    s.cell_wrong = s.cell_away + cells * SV_LANES;
    s.slices.begun = (__global u16l *)(s.cell_wrong + cells * SV_LANES);
    s.slices.near = (__global u8l *)(s.slices.begun + l->slices);
    s.cell_rays = (__global uint *)(s.slices.near + l->slices);
    return s;
}

static ulong sum_lanes(u16l values) {
    const ushort *lanes = (const ushort *)&values;
    ulong sum = 0;
    for (uint i = 0; i < LANES; i++) sum += lanes[i];
    return sum;
}

/* The costs of the rays of one column of vectors, of all rows of a row of cells. Gives back the sum over its
 * rays of the probability that the fetus is on them; a row between two cells counts with the first. */
static ulong walk_column(const sv_wall_layout *l, const scratch_t *s, __global const u8l *tissue,
                         __global const u8l *bright, __global ushort *rays, __global const uint *chances,
                         uint x, uint cell_row) {
    u16l counts = (u16l)(0);
    ulong fetus = 0;
    for (uint k = 0; k < l->labels; k++) s->away[k] = s->wrong[k] = (u32l)(0);
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
        if (cell == cell_row) fetus += sum_lanes(r.begun & AS_U16(r.end > r.first));
        walk_back_costs(l, &r, &s->slices, 2 / number, s->away, s->wrong);
        counts += AS_U16(r.end > r.first) & (ushort)(2 / number);
    }
    to_cells(l, x * LANES, (const ushort *)&counts, s->away, s->wrong, s->cell_away, s->cell_wrong,
             s->cell_rays);
    return fetus;
}

/* One work item per row of cells: their costs, and of these what is due to the distance from the fluid.
 * `scratch`: scratch_vectors a row of cells. */
__kernel void wall_costs(sv_wall_layout l, uint scratch_vectors, __global const uint *restrict info,
                         __global const u8l *restrict tissue, __global const u8l *restrict bright,
                         __global ushort *restrict rays, __global uint16 *restrict scratch,
                         __global uint16 *restrict costs, __global uint16 *restrict aways,
                         __global ulong *restrict fetus) {
    const uint row = (uint)get_global_id(0), vectors = padded_width_of(&l) / LANES;
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
