/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, costs: what every ray pays for being clipped at every layer.
 *
 * LANES rays are walked front to back, which tells where the fetus begins and how far the fluid in front is,
 * and back to front, which tells how far the fluid behind is and what the fluid leaves to the tissue behind
 * it.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif

/* LANES rays, and what is known of them. */
typedef struct {
    __global const uchar *levels, *bright; /* of the first layer */
    size_t level_pitch, bright_pitch;      /* from one layer to the next */
    u8l threshold;
    __global const uint *chances;
    bool bare;                     /* there is no wall */
    i16l first, end, run, run_end; /* scanned layers, the first tissue */
    i16l touches;                  /* that begins where the scan does */
    i16l fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    u16l begun, in_run;            /* probability of a fetus; of one that begins in the first tissue */
} rays_t;

/* What is kept of every layer of LANES rays while they are walked. */
typedef struct {
    __global u16l *begun; /* probability that the fetus has begun */
    __global u8l *near;   /* distance to the fluid in front */
} layers_t;

static u8l tissue_at(const rays_t *r, uint z) {
    return AS_U8(*(__global const u8l *)(r->levels + z * r->level_pitch) > r->threshold);
}

/* Shares of a value, a number or one a ray, rounded half up. */
static u32l share(u32l value, u16l chance) {
    return (value * TO_U32(chance) + SV_WALL_SURE / 2u) / (uint)SV_WALL_SURE;
}

/* The same of costs, which have 13 bits at most, in 16 bits. */
static u16l share_of_cost(uint cost, u16l chance) {
    const u16l twice = (u16l)((ushort)(2 * cost));
    const u16l high = TO_U16((TO_U32(twice) * TO_U32(chance)) >> 16u), low = twice * chance;
    return high + (low >> (ushort)15);
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

/* Front to back. */
static void walk_forth(const sv_wall_layout *l, rays_t *r, const layers_t *s) {
    const u8l far = (u8l)((uchar)l->far);
    const i16l scanned = r->end > r->first;
    const u8l open_front = bytes_of(scanned & ~r->touches);
    u16l before = (u16l)(SV_WALL_SURE), now = before;
    u8l most = (u8l)(0), behind = most, near = far, over = (u8l)(0);
    r->fluid_end = r->end;
    for (uint z = 0; z < l->layers; z++) {
        const i16l at = (i16l)((short)z);
        const u8l tissue = tissue_at(r, z);
        const u8l bright = *(__global const u8l *)(r->bright + z * r->bright_pitch) & tissue;
        const u8l asks = tissue & (AS_U8(bright > most) | ~behind);
        most &= tissue;
        most = MOST(most, bright);
        if (some_bytes(asks)) {
            const u16l chance = chances_of(r, most, r->touches & (r->run_end > at));
            now = PICK(now, before - TO_U16(share(TO_U32(before), chance)), AS_U16(words_of(tissue)));
        }
        before = PICK(now, before, AS_U16(words_of(tissue)));
        s->begun[z] = (u16l)(SV_WALL_SURE)-now;
        const u8l fluid =
            (bytes_of((r->first <= at) & (r->end > at)) & ~tissue) | (open_front & bytes_of(r->first > at));
        near = LEAST(near + (u8l)(1), far) & ~fluid;
        s->near[z] = near;
        /* tissue behind the first fluid */
        const u8l enters = tissue & ~behind & bytes_of(r->run_end < at) & ~over;
        if (some_bytes(enters)) r->fluid_end = PICK(r->fluid_end, at, words_of(enters));
        over |= enters;
        behind = tissue;
    }
    /* An open front, or no fluid at all: all that is before the tissue. */
    const i16l in_front = ~(r->touches & (r->run_end < r->end));
    r->fluid = r->run_end & ~in_front;
    r->fluid_end = PICK(r->fluid_end, r->run, in_front);
    r->begun = (u16l)(SV_WALL_SURE)-now;
}

/* Probability that the fetus begins in the first tissue, where that begins with the scan. */
static void find_in_run(rays_t *r, const layers_t *s) {
    const i16l has_run = r->touches & (r->run_end > r->run);
    const short *end = (const short *)&r->run_end, *some = (const short *)&has_run;
    for (uint i = 0; i < LANES; i++) {
        const uint last = some[i] ? (uint)(end[i] - 1) : 0;
        const ushort begun = ((__global const ushort *)(s->begun + last))[i];
        ((ushort *)&r->in_run)[i] = some[i] ? begun : (ushort)0;
    }
}

/* What LANES rays pay in layer z but for the distance. `later`: probability that the fetus begins with tissue
 * whose fluid is behind the layer. */
static u16l wrong_at(const sv_wall_layout *l, const rays_t *r, const layers_t *s, uint z, u16l later) {
    const i16l at = (i16l)((short)z);
    u16l cost = share_of_cost(l->left, later);
    if (z > 0 || !r->bare) cost += share_of_cost(l->cut, s->begun[z]);
    const uint skin = z + l->skin;
    if (skin < l->layers) {
        const i16l over = r->touches & (r->run_end > (i16l)((short)skin));
        if (some_words(over)) cost += share_of_cost(l->left, (r->in_run - s->begun[skin]) & AS_U16(over));
    }
    const i16l other = (at < r->fluid) | (at >= r->fluid_end);
    return cost + share_of_cost(l->other, ((u16l)(SV_WALL_SURE)-r->begun) & AS_U16(other));
}

static u16l away_at(const sv_wall_layout *l, u8l near) {
    const u16l far = (TO_U16(near) * (ushort)l->rate + (ushort)(1u << (SV_WALL_RATE_BITS - 1))) >>
                     (ushort)SV_WALL_RATE_BITS;
    return LEAST(far, (u16l)(SV_WALL_ONE));
}

/* Back to front: leaves the costs of LANES rays in layers `pitch` apart. */
static void walk_back(const sv_wall_layout *l, const rays_t *r, const layers_t *s, size_t pitch,
                      __global ushort *costs, __global uchar *aways) {
    const u8l far = (u8l)((uchar)l->far);
    const i16l scanned = r->end > r->first;
    u8l behind = (u8l)(0), fluid_behind = behind, near = far;
    u16l later = (u16l)(0), run_end = r->begun;
    for (uint z = l->layers; z-- > 0;) {
        const u8l tissue = tissue_at(r, z), before = s->near[z], fluid = AS_U8(before == (u8l)(0));
        const u16l begun = s->begun[z];
        later += (run_end - begun) & AS_U16(words_of(tissue & fluid_behind));
        run_end = PICK(run_end, begun, AS_U16(words_of(tissue & ~behind)));
        fluid_behind = fluid;
        behind = tissue;
        near = LEAST(near + (u8l)(1), far) & ~fluid;
        const u16l away = away_at(l, LEAST(near, before));
        const u16l cost = away + wrong_at(l, r, s, z, later);
        *(__global u16l *)(costs + z * pitch) = cost & AS_U16(scanned);
        *(__global u8l *)(aways + z * pitch) = TO_U8(away) & bytes_of(scanned);
    }
}

static void load_rays(const sv_wall_layout *l, __global ushort *rays, uint x, uint row, rays_t *r) {
    r->first = AS_I16(ray_row(rays, l, RAY_FIRST, row)[x]);
    r->end = AS_I16(ray_row(rays, l, RAY_END, row)[x]);
    r->run = AS_I16(ray_row(rays, l, RAY_RUN, row)[x]);
    r->run_end = AS_I16(ray_row(rays, l, RAY_RUN_END, row)[x]);
    r->touches = (r->end > r->first) & (r->run == r->first);
}

static ulong sum_lanes(u16l values) {
    const ushort *lanes = (const ushort *)&values;
    ulong sum = 0;
    for (uint i = 0; i < LANES; i++) sum += lanes[i];
    return sum;
}

/* One work item per row of rays: their costs, of these what is due to the distance from the fluid, and the
 * sum of the probabilities that the fetus is on them. `scratch`: scratch_words words of 32 bits for each row.
 */
__kernel void wall_costs(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                         __global const uchar *restrict levels, __global const uchar *restrict bright,
                         __global ushort *restrict rays, __global uint *restrict scratch,
                         __global ushort *restrict costs, __global uchar *restrict aways,
                         __global ulong *restrict fetus) {
    const uint row = (uint)get_global_id(0);
    const size_t pitch = block_row(&l, 1, 0);
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    layers_t s;
    s.begun = (__global u16l *)(scratch + (size_t)row * scratch_words);
    s.near = (__global u8l *)(s.begun + l.layers);
    rays_t r;
    r.threshold = (u8l)((uchar)info[INFO_TISSUE]);
    r.chances = info + INFO_CHANCES;
    r.bare = info[INFO_BARE];
    r.level_pitch = level_row(&l, 1, 0) - level_row(&l, 0, 0);
    r.bright_pitch = pitch;
    ulong sum = 0;
    for (uint x = 0; x < vectors_of(&l); x++) {
        r.levels = levels + level_row(&l, 0, row) + x * LANES;
        r.bright = bright + block_row(&l, 0, row) + x * LANES;
        load_rays(&l, rays, x, row, &r);
        walk_forth(&l, &r, &s);
        find_in_run(&r, &s);
        sum += sum_lanes(r.begun & AS_U16(r.end > r.first));
        walk_back(&l, &r, &s, pitch, costs + block_row(&l, 0, row) + x * LANES,
                  aways + block_row(&l, 0, row) + x * LANES);
    }
    fetus[row] = sum;
}
