/* SPDX-License-Identifier: MIT */
/*
 * Costs: what every cell of two by two rays pays for being clipped at every layer.
 *
 * The forward pass over LANES rays finds where the fetus begins, and the distance to the fluid in front. The
 * backward pass finds the distance to the fluid behind, and how likely the tissue behind each fluid is the
 * fetus.
 */
#ifndef SV_WALL_SURROUNDINGS_CLH
#include "wall/wall_surroundings.clh"
#endif

/* Stands before a loop over both rows of rays, so that what is known of them stays in registers. */
#define UNROLL _Pragma("unroll")

/* The state of LANES rays. */
typedef struct {
    __global const uchar *levels;  /* of the first layer */
    i16l first, end, run, run_end; /* scanned layers, the first run */
    i16l scanned;                  /* there are scanned layers */
    i16l touches;                  /* the first run begins where the scan does */
    i16l fluid, fluid_end;         /* where the surface belongs if there is no fetus */
    i16l front;                    /* RAY_FRONT */
    u16l fetus, in_run;            /* probability of a fetus; of one that begins in the first run */
    u16l doubt;                    /* probability of a fetus that begins with a run behind what is no fluid */
    /* for every layer: probability that the fetus has begun, distance to the fluid in front */
    __global u16l *fetus_at;
    __global u8l *near_at;
} rays_t;

/* The state of the two rows of rays that HALF cells have. */
typedef struct {
    rays_t rays[2];
    size_t level_pitch, cell_pitch;   /* from one layer to the next */
    bool bare;                        /* there is no wall */
    __global const uchar *brightness; /* of the first layer */
    __global const ulong *flags;      /* of the first layer */
    size_t word_pitch;                /* from one word of `flags` to the next */
    /* of every brightness: the probability of a later run * 65536 + of a first run */
    __global const uint *by_brightness;
    extent_t layers;   /* those in which costs change from one to the next */
    uint certain_from; /* from this layer on the fetus has begun on all scanned rays; at least 1, because
                          cutting at depth 0 may cost nothing */
} cell_rays_t;

static u8l level_at(const cell_rays_t *s, const rays_t *r, uint z) {
    return *(__global const u8l *)(r->levels + z * s->level_pitch);
}

/* Multiplies probabilities, rounding half up. */
static u16l share(u16l value, u16l probability) {
    const u16l low =
        ((value * probability >> (ushort)1) + (ushort)(SV_WALL_PROBABILITY_ONE / 4)) >> (ushort)14;
    return (high_of(value, probability) << (ushort)1) + low;
}

/* Multiplies a cost of at most 13 bits by probabilities, rounding down. */
static u16l share_of_cost(uint cost, u16l probability) {
    return high_of((u16l)((ushort)(2 * cost)), probability);
}

/* Returns how certain fluid is: fully where it is `known`, else by the level of its darkest block. */
static u16l certainty_of(const sv_wall_layout *l, u8l level, i16l known) {
    const u16l dark = ((u16l)(SV_WALL_TISSUE)-TO_U16(level)) * (ushort)l->darkness;
    const u16l certain = AS_U16(known | words_of(AS_U8(level <= (u8l)((uchar)l->dim))));
    return SELECT(share(dark, dark), (u16l)(SV_WALL_PROBABILITY_ONE), certain);
}

/* Looks up the probabilities of the brightnesses of HALF cells. */
static u32h look_up(const cell_rays_t *s, uint z) {
    const u32h brightness = HALF_TO_U32(*(__global const u8h *)(s->brightness + z * s->cell_pitch));
    u32h found;
    TABLE_LOADS
    for (uint i = 0; i < HALF; i++) /* signed indices need no wider ones */
        ((uint *)&found)[i] = s->by_brightness[((const int *)&brightness)[i]];
    return found;
}

/* The state of the forward pass: the probability that the fetus has not begun before this run, and so far;
 * the maximum probability that the run has shown. */
typedef struct {
    u16l before, now, maximum;
    u8l behind, near, over; /* tissue in the layer before; distance to the fluid; the first fluid has ended */
    u8l darkest;            /* level of the darkest block of the fluid in front */
    u16l certain;           /* that there is fluid in front of the run, */
    i16l begin;             /* which begins here */
} forward_t;

static i32h has_bit(u32h flags, uint bit) {
    return REINTERPRET(flags * (0x80000000u / bit), i32h) < (i32h)(0);
}

/* Changes the probabilities that were looked up by what surrounds the cells. Enclosed tissue is judged like
 * a first run. A first run that the fetus flanks is judged like a later one; what it reaches from one side
 * is moved by `one_side` from the one probability to the other. `floats`: the cells where a limb floats; all
 * of it is judged like a later run. */
static u32h probabilities_at(const sv_wall_layout *l, const cell_rays_t *s, uint z, u32h *floats) {
    u8h cells;
    for (uint i = 0; i < WORDS_OF_HALF; i++) ((ulong *)&cells)[i] = s->flags[i * s->word_pitch + z];
    const u32h looked_up = look_up(s, z), flags = HALF_TO_U32(cells);
    const u32h any = looked_up >> 16u, first = looked_up & 0xffffu;
    const u32h part =
        ((any - first) * l->one_side + (uint)(SV_WALL_PROBABILITY_ONE / 2)) / (uint)SV_WALL_PROBABILITY_ONE;
    const u32h beside = SELECT(first, first + part, has_bit(flags, CELL_ADJACENT));
    const i32h is_limb = has_bit(flags, CELL_FLOATS);
    *floats = REINTERPRET(is_limb, u32h);
    return SELECT(any, first, has_bit(flags, CELL_ENCLOSED) & ~is_limb) << 16u |
           SELECT(beside, any, has_bit(flags, CELL_FLANKED) | is_limb);
}

/* Accumulates the probability that the fetus has begun. `both`: probabilities of the cells, of a later run *
 * 65536 + of a first run; two rays share a word. `floats`: the mask of cells where a limb floats. */
static void forward_fetus(const sv_wall_layout *l, rays_t *r, uint z, u16l tissue, u32h both, u32h floats,
                          forward_t *w) {
    const u16l any = REINTERPRET(both >> 16u | (both & 0xffff0000u), u16l);
    const u16l first = REINTERPRET((both & 0xffffu) | both << 16u, u16l);
    const u16l in_run = AS_U16(r->touches & (r->run_end > (i16l)((short)z))) & tissue;
    const i16l behind_skin = r->run <= (i16l)((short)z - (short)l->skin); /* the skin tells nothing */
    const u16l counts = AS_U16(behind_skin) | REINTERPRET(floats, u16l);
    const u16l probability = SELECT(any, first & counts, in_run);
    w->maximum = MAXIMUM(w->maximum, probability) & tissue;
    w->now = SELECT(w->now, w->before - share(w->before, w->maximum), tissue);
    w->before = SELECT(w->now, w->before, tissue);
    const u16l fetus = (u16l)(SV_WALL_PROBABILITY_ONE)-w->now;
    r->in_run = SELECT(r->in_run, fetus, in_run);
    const i16l likely = AS_I16(fetus >= (u16l)(SV_WALL_LIKELY)) & (r->front == (i16l)((short)l->layers));
    r->front = SELECT(r->front, w->begin, likely);
    r->fetus_at[z] = fetus;
}

/* The same in a layer without tissue. */
static void forward_no_tissue(rays_t *r, uint z, forward_t *w) {
    w->maximum = (u16l)(0);
    w->before = w->now;
    r->fetus_at[z] = (u16l)(SV_WALL_PROBABILITY_ONE)-w->now;
}

/* Adds to the doubt what the runs that have ended have of it. They have none left then. */
static void end_run(rays_t *r, u8l ended, forward_t *w) {
    if (!any_byte(ended)) return;
    const u16l ends = AS_U16(words_of(ended)), begins = w->before - w->now;
    r->doubt += (begins - share(begins, w->certain)) & ends;
    w->before = SELECT(w->before, w->now, ends);
}

/* Finds how certain the fluid in front of runs is that begin in layer z. That which ends a first run is. */
static void forward_doubt(const sv_wall_layout *l, rays_t *r, uint z, u8l level, u8l tissue, forward_t *w) {
    end_run(r, w->behind & ~tissue, w);
    const u8l begins = tissue & ~w->behind;
    if (any_byte(begins)) {
        const i16l known = (r->touches | (r->run_end > (i16l)((short)z))) & ~words_of(w->over);
        w->certain = SELECT(w->certain, certainty_of(l, w->darkest, known), AS_U16(words_of(begins)));
        w->begin = SELECT(w->begin, (i16l)((short)z), words_of(begins));
    }
    w->darkest = SELECT(MINIMUM(w->darkest, level), (u8l)(SV_WALL_TISSUE), tissue);
}

static void forward_fluid(const sv_wall_layout *l, rays_t *r, uint z, u8l tissue, forward_t *w) {
    const i16l at = (i16l)((short)z);
    const u8l open_front = bytes_of(r->scanned & ~r->touches & (r->first > at));
    const u8l fluid = (bytes_of((r->first <= at) & (r->end > at)) & ~tissue) | open_front;
    w->near = MINIMUM(w->near + (u8l)(1), (u8l)((uchar)l->full_distance)) & ~fluid;
    r->near_at[z] = w->near;
    /* tissue behind the first fluid */
    const u8l enters = tissue & ~w->behind & bytes_of(r->run_end < at) & ~w->over;
    r->fluid_end = SELECT(r->fluid_end, at, words_of(enters));
    w->over |= enters;
    w->behind = tissue;
}

/* Sets the state in front of the first layer. */
static void forward_begin(const sv_wall_layout *l, rays_t *r, forward_t *w) {
    w->before = w->now = w->certain = (u16l)(SV_WALL_PROBABILITY_ONE);
    w->maximum = (u16l)(0);
    w->darkest = (u8l)(SV_WALL_TISSUE);
    w->behind = w->over = (u8l)(0);
    w->near = (u8l)((uchar)l->full_distance);
    w->begin = (i16l)(0);
    r->front = (i16l)((short)l->layers);
    r->fluid_end = r->end;
    r->in_run = r->doubt = (u16l)(0);
}

/* Finds the first fluid, once the last layer is passed. With an open front, or without fluid, the surface
 * belongs in front of the tissue. A run at the start of the scan has no fluid in front of it. */
static void forward_end(const sv_wall_layout *l, rays_t *r, forward_t *w) {
    end_run(r, w->behind, w);
    const i16l in_front = ~(r->touches & (r->run_end < r->end));
    r->fluid = r->run_end & ~in_front;
    r->fluid_end = SELECT(r->fluid_end, r->run, in_front);
    r->front = SELECT(r->front, (i16l)((short)l->layers), r->front == r->first);
    r->fetus = (u16l)(SV_WALL_PROBABILITY_ONE)-w->now;
    const i16l possible = AS_I16(r->fetus >= (u16l)(SV_WALL_POSSIBLE));
    const i16l no_front = possible & (r->front == (i16l)((short)l->layers));
    r->front = SELECT(r->front, (i16l)((short)SV_WALL_NO_FRONT), no_front);
}

/* Accumulates the probability in layer z, and the doubt. Once the fetus has begun on all rays, neither
 * changes any more. */
static void forward_layer(const sv_wall_layout *l, cell_rays_t *s, uint z, const u8l levels[2],
                          const u8l tissue[2], forward_t w[2]) {
    rays_t *const r = s->rays;
    UNROLL for (uint i = 0; i < 2; i++) forward_doubt(l, &r[i], z, levels[i], tissue[i], &w[i]);
    if (!any_byte(tissue[0] | tissue[1])) {
        UNROLL for (uint i = 0; i < 2; i++) forward_no_tissue(&r[i], z, &w[i]);
        return;
    }
    u32h floats;
    const u32h probabilities = probabilities_at(l, s, z, &floats);
    UNROLL for (uint i = 0; i < 2; i++)
        forward_fetus(l, &r[i], z, AS_U16(words_of(tissue[i])), probabilities, floats, &w[i]);
    const i16l open = (AS_I16(w[0].now) & r[0].scanned) | (AS_I16(w[1].now) & r[1].scanned);
    if (z == 0 || any_word(open)) return;
    s->certain_from = z;
    UNROLL for (uint i = 0; i < 2; i++) end_run(&r[i], tissue[i], &w[i]);
}

/* Walks the layers from front to back. */
static void forward_pass(const sv_wall_layout *l, cell_rays_t *s) {
    rays_t *const r = s->rays;
    forward_t w[2];
    s->certain_from = l->layers;
    UNROLL for (uint i = 0; i < 2; i++) forward_begin(l, &r[i], &w[i]);
    for (uint z = s->layers.from; z < s->layers.to; z++) {
        const u8l levels[2] = {level_at(s, &r[0], z), level_at(s, &r[1], z)};
        const u8l tissue[2] = {tissue_of(levels[0]), tissue_of(levels[1])};
        if (s->certain_from == l->layers) forward_layer(l, s, z, levels, tissue, w);
        UNROLL for (uint i = 0; i < 2; i++) forward_fluid(l, &r[i], z, tissue[i], &w[i]);
    }
    UNROLL for (uint i = 0; i < 2; i++) forward_end(l, &r[i], &w[i]);
}

/* Returns what LANES rays pay in layer z, in front of `certain_from`, but for the distance. `later`:
 * probability that the fetus begins with a run whose fluid is behind the layer. `wrong_fluid`: what the
 * layer costs outside the fluid where the surface belongs if there is no fetus. */
static u16l error_cost(const sv_wall_layout *l, const cell_rays_t *s, const rays_t *r, uint z, u16l later,
                       u16l wrong_fluid) {
    const i16l at = (i16l)((short)z);
    const uint skin = z + l->skin;
    if (skin < min(l->layers, s->certain_from)) { /* from there on the fetus has begun */
        const i16l over = r->touches & (r->run_end > (i16l)((short)skin));
        if (any_word(over)) later += (r->in_run - r->fetus_at[skin]) & AS_U16(over);
    }
    u16l cost = share_of_cost(l->occluder_cost, later);
    if (z > 0 || !s->bare) cost += share_of_cost(l->cut_cost, r->fetus_at[z]);
    const i16l other = (at < r->fluid) | (at >= r->fluid_end);
    return cost + (wrong_fluid & AS_U16(other));
}

static u16l distance_cost_at(const sv_wall_layout *l, u8l near) {
    const u16l far = (TO_U16(near) * (ushort)l->rate + (ushort)(1u << (SV_WALL_RATE_BITS - 1))) >>
                     (ushort)SV_WALL_RATE_BITS;
    return MINIMUM(far, (u16l)(SV_WALL_COST_ONE));
}

/* Means of two by two rays, rounded half up, from the sums of both rows of rays. */
static u32h mean_of_cells(u16l sums) {
    const u32h pairs = REINTERPRET(sums, u32h); /* neighbours share a word */
    return ((pairs & 0xffffu) + (pairs >> 16u) + 2u) >> 2u;
}

/* The state of the backward pass: tissue and fluid behind, and the distance to that fluid; the probability
 * that the fetus begins with a run whose fluid is behind or is none, or in or in front of the run behind;
 * what a layer costs where the fetus has begun. */
typedef struct {
    u8l behind, fluid_behind, near;
    u8l darkest; /* level of the darkest block of the fluid behind */
    u16l later, run_end, wrong_fluid, cut;
} backward_t;

static void backward_begin(const sv_wall_layout *l, const rays_t *r, backward_t *w) {
    w->behind = w->fluid_behind = (u8l)(0);
    w->near = (u8l)((uchar)l->full_distance);
    w->darkest = (u8l)(SV_WALL_TISSUE);
    w->later = r->doubt;
    w->cut = share_of_cost(l->occluder_cost, r->doubt) + (ushort)l->cut_cost;
    w->run_end = r->fetus;
    w->wrong_fluid = share_of_cost(SV_WALL_COST_ONE, (u16l)(SV_WALL_PROBABILITY_ONE)-r->fetus);
}

/* Adds the probability `probability` that the fetus begins with the run behind, on rays where layer z is the
 * last of tissue in front of its fluid, by how certain that is fluid. The doubt is there already. */
static void add_later(const sv_wall_layout *l, const rays_t *r, uint z, u16l probability, u16l last,
                      backward_t *w) {
    const i16l ends_first = r->touches & (r->run_end == (i16l)((short)(z + 1)));
    w->later += share(probability, certainty_of(l, w->darkest, ends_first)) & last;
}

/* Returns what LANES rays pay in layer z. */
static u16l backward_step(const sv_wall_layout *l, const cell_rays_t *s, const rays_t *r, uint z,
                          backward_t *w) {
    const u8l level = level_at(s, r, z), tissue = tissue_of(level);
    const u8l before = r->near_at[z], fluid = AS_U8(before == (u8l)(0)), last = tissue & w->fluid_behind;
    u16l wrong = w->cut; /* where the fetus has begun */
    if (z < s->certain_from) {
        const u16l fetus = r->fetus_at[z];
        if (any_byte(last)) add_later(l, r, z, w->run_end - fetus, AS_U16(words_of(last)), w);
        w->run_end = SELECT(w->run_end, fetus, AS_U16(words_of(tissue & ~w->behind)));
        w->darkest = SELECT(MINIMUM(w->darkest, level), (u8l)(SV_WALL_TISSUE), tissue);
        wrong = error_cost(l, s, r, z, w->later, w->wrong_fluid);
    }
    w->fluid_behind = fluid;
    w->behind = tissue;
    w->near = MINIMUM(w->near + (u8l)(1), (u8l)((uchar)l->full_distance)) & ~fluid;
    return (distance_cost_at(l, MINIMUM(w->near, before)) + wrong) & AS_U16(r->scanned);
}

/* Gives layers the costs of layer z. */
static void repeat_costs(const cell_rays_t *s, __global ushort *costs, uint z, extent_t layers) {
    const u16h same = *(__global const u16h *)(costs + z * s->cell_pitch);
    for (uint to = layers.from; to < layers.to; to++) *(__global u16h *)(costs + to * s->cell_pitch) = same;
}

/* Walks the layers from back to front. It stores the costs of HALF cells, in all layers. */
static void backward_pass(const sv_wall_layout *l, const cell_rays_t *s, __global ushort *costs) {
    backward_t w[2];
    UNROLL for (uint i = 0; i < 2; i++) backward_begin(l, &s->rays[i], &w[i]);
    for (uint z = s->layers.to; z-- > s->layers.from;) {
        u16l cost[2];
        UNROLL for (uint i = 0; i < 2; i++) cost[i] = backward_step(l, s, &s->rays[i], z, &w[i]);
        *(__global u16h *)(costs + z * s->cell_pitch) = HALF_TO_U16(mean_of_cells(cost[0] + cost[1]));
    }
    repeat_costs(s, costs, s->layers.from, (extent_t){0, s->layers.from});
    repeat_costs(s, costs, s->layers.to - 1, (extent_t){s->layers.to, l->layers});
}

static void load_rays(const sv_wall_layout *l, __global ushort *rays, uint x, uint row, rays_t *r) {
    r->first = AS_I16(ray_row(rays, l, RAY_FIRST, row)[x]);
    r->end = AS_I16(ray_row(rays, l, RAY_END, row)[x]);
    r->run = AS_I16(ray_row(rays, l, RAY_RUN, row)[x]);
    r->run_end = AS_I16(ray_row(rays, l, RAY_RUN_END, row)[x]);
    r->scanned = r->end > r->first;
    r->touches = r->scanned & (r->run == r->first);
}

static ulong sum_lanes(u16l values) {
    const ushort *lanes = (const ushort *)&values;
    ulong sum = 0;
    for (uint i = 0; i < LANES; i++) sum += lanes[i];
    return sum;
}

/* One work item per row of cells: stores their costs, and the sum
 * over the rays of the probability that the fetus is on them. `scratch`: scratch_words words of 32 bits for
 * each row. */
__kernel void wall_costs(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                         __global const uchar *restrict levels, __global const uchar *restrict brightness,
                         __global ulong *restrict flags, __global ushort *restrict rays,
                         __global uint *restrict scratch, __global ushort *restrict costs,
                         __global ulong *restrict fetus) {
    const uint row = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    cell_rays_t s = {.level_pitch = level_pitch_of(&l),
                     .cell_pitch = padded_cells_of(&l),
                     .word_pitch = padded_layers_of(&l),
                     .bare = info[SV_WALL_INFO_BARE] != 0,
                     .by_brightness = info + SV_WALL_INFO_PROBABILITIES};
    s.rays[0].fetus_at = (__global u16l *)(scratch + (size_t)row * scratch_words);
    s.rays[1].fetus_at = s.rays[0].fetus_at + l.layers;
    s.rays[0].near_at = (__global u8l *)(s.rays[1].fetus_at + l.layers);
    s.rays[1].near_at = s.rays[0].near_at + l.layers;
    ulong sum = 0;
    find_flanked_in_row(&l, row, extent_of_row(&l, rays, row), flags);
    for (uint x = 0; x < vectors_of(&l); x++) {
        const size_t at = cell_row(&l, 0, row) + x * HALF;
        s.layers = changing_layers(&l, extent_of_vector(&l, rays, row, x));
        s.brightness = brightness + at;
        s.flags = flags + word_column(&l, row, x * WORDS_OF_HALF);
        UNROLL for (uint i = 0; i < 2; i++) {
            s.rays[i].levels = levels + level_row(&l, 0, 2 * row + i) + x * LANES;
            load_rays(&l, rays, x, 2 * row + i, &s.rays[i]);
        }
        forward_pass(&l, &s);
        UNROLL for (uint i = 0; i < 2; i++) {
            ray_row(rays, &l, RAY_FRONT, 2 * row + i)[x] = AS_U16(s.rays[i].front);
            sum += sum_lanes(s.rays[i].fetus & AS_U16(s.rays[i].scanned));
        }
        backward_pass(&l, &s, costs + at);
    }
    fetus[row] = sum;
}
