/* SPDX-License-Identifier: MIT */
/*
 * From costs to the cheapest layer of every ray: the costs of rays between cells, the minimum, the mean
 * around it, and how far around it the knob may move the surface.
 */
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
#endif

/* Multiplies by three; a multiplication takes ten cycles. */
static u32h thrice(u32h a) {
    return (a << 1u) + a;
}

/* Returns costs between two rows of cells, times 4: three quarters of a row and a quarter of the other. */
static u32h between_rows(__global const ushort *own, __global const ushort *other) {
    const u32h a = HALF_TO_U32(((__global const u16h_unaligned *)own)->v);
    return thrice(a) + HALF_TO_U32(((__global const u16h_unaligned *)other)->v);
}

/* Interpolates the costs of LANES rays between the four cells around each, linear and rounded half up.
 * `own`: at the first of their cells; `other`: in the row next to it. */
static u16l between_cells(__global const ushort *own, __global const ushort *other) {
    const u32h here = thrice(between_rows(own, other)) + 8u;
    const u32h left = (here + between_rows(own - 1, other - 1)) >> 4u;
    const u32h right = (here + between_rows(own + 1, other + 1)) >> 4u;
    return REINTERPRET(left | right << 16u, u16l); /* neighbours share a word */
}

/* Finds the cheapest layer of LANES rays; of several equal ones the nearest to the viewer. Outside of
 * `changing` no cost differs from the next. */
static u16l minimum_layer(__global const u16l *costs, extent_t changing, u16l *minimum) {
    u16l best = (u16l)(0);
    *minimum = costs[changing.from];
    for (uint z = changing.from + 1; z < changing.to; z++) {
        const u16l cost = costs[z];
        const u16l less = AS_U16(cost < *minimum);
        *minimum = MINIMUM(*minimum, cost);
        best = SELECT(best, (u16l)((ushort)z), less);
    }
    return best;
}

/* Layers from .. to - 1 hold all layers around the cheapest ones that cost less than the limit. */
typedef struct {
    uint from, to;
} window_t;

static window_t window_of(const sv_wall_layout *l, __global const u16l *costs, u16l best, u16l limit) {
    const ushort *lanes = (const ushort *)&best;
    window_t w = {lanes[0], lanes[0]};
    for (uint i = 1; i < LANES; i++) {
        w.from = min(w.from, (uint)lanes[i]);
        w.to = max(w.to, (uint)lanes[i]);
    }
    while (w.from > 0 && any_word(AS_I16(costs[w.from - 1] < limit))) w.from--;
    do w.to++;
    while (w.to < l->layers && any_word(AS_I16(costs[w.to] < limit)));
    return w;
}

/* Averages the layers around the cheapest one whose cost is below the limit, weighting each by how far it is
 * below. */
static f32l mean_around(const window_t *w, __global const u16l *costs, u16l best, u16l limit) {
    u32l weight = (u32l)(0), sum = weight;
    i16l over = (i16l)(0);
    for (uint z = w->from; z < w->to; z++) {
        const u16l cost = costs[z];
        const i16l in = AS_I16(cost < limit), before = AS_I16(best > (u16l)((ushort)z));
        over |= ~in & ~before;
        const u32l less = TO_U32((limit - cost) & AS_U16(in & ~over));
        const u32l keep = AS_U32(TO_I32(in | ~before));
        weight = (weight & keep) + less;
        sum = (sum & keep) + less * z;
    }
    f32l mean;
    for (uint i = 0; i < LANES; i++) {
        const uint by = ((const uint *)&weight)[i];
        const float quotient = (float)((const uint *)&sum)[i] / (float)(by ? by : 1u);
        ((float *)&mean)[i] = by ? quotient : (float)((const ushort *)&best)[i];
    }
    return mean;
}

/* One end of the layers around the cheapest one that cost less than a limit: the last of them, its cost, and
 * the cost of the next one. */
typedef struct {
    u16l last, inside, outside;
} end_t;

/* Returns how far behind `inside` the costs cross the limit, in layers. */
static f32l crossing(const end_t *e, u16l limit) {
    return TO_F32(limit - e->inside) / TO_F32(e->outside - e->inside);
}

/* Finds how far around the cheapest layer the costs stay below the limit, but not beyond `place`. */
static void find_ends(const sv_wall_layout *l, const window_t *w, __global const u16l *costs, u16l best,
                      u16l limit, f32l place, __global f32l *near, __global f32l *far) {
    const u16l over_limit = limit + (ushort)1;
    end_t before = {(u16l)(0), limit, over_limit},
          behind = {(u16l)((ushort)(l->layers - 1)), limit, over_limit};
    i16l over = (i16l)(0);
    for (uint z = max(w->from, 1u); z <= min(w->to, l->layers - 1); z++) {
        const u16l last = costs[z - 1], cost = costs[z], at = (u16l)((ushort)z);
        const i16l falls = AS_I16((last >= limit) & (cost < limit)),
                   rises = AS_I16((last < limit) & (cost >= limit));
        const u16l enters = AS_U16(falls & AS_I16(best >= at));
        const i16l leaves = rises & AS_I16(best < at) & ~over;
        before.last = SELECT(before.last, at, enters);
        before.inside = SELECT(before.inside, cost, enters);
        before.outside = SELECT(before.outside, last, enters);
        behind.last = SELECT(behind.last, at - (ushort)1, AS_U16(leaves));
        behind.inside = SELECT(behind.inside, last, AS_U16(leaves));
        behind.outside = SELECT(behind.outside, cost, AS_U16(leaves));
        over |= leaves;
    }
    const f32l first = TO_F32(before.last) - crossing(&before, limit);
    const f32l end = TO_F32(behind.last) + crossing(&behind, limit);
    *near = MINIMUM(first, place);
    *far = MAXIMUM(end, place);
}

/* Finds the minima of LANES rays, and what they cost. `planes`: where they lie in the first plane. */
static void find_minima(const sv_wall_layout *l, __global const u16l *costs, extent_t changing,
                        __global float *planes) {
    const size_t plane = plane_row(l, 1, 0);
    u16l minimum;
    const u16l best = minimum_layer(costs, changing, &minimum);
    const window_t w = window_of(l, costs, best, minimum + (ushort)max(l->average_margin, l->knob_margin));
    const f32l mean = mean_around(&w, costs, best, minimum + (ushort)l->average_margin);
    *(__global f32l *)(planes + PLANE_LAYER * plane) = mean;
    *(__global f32l *)(planes + PLANE_COST * plane) = TO_F32(minimum) / (float)SV_WALL_FINE_COST_ONE;
    find_ends(l, &w, costs, best, minimum + (ushort)l->knob_margin, mean,
              (__global f32l *)(planes + PLANE_NEAR * plane), (__global f32l *)(planes + PLANE_FAR * plane));
}

/* Finds the costs of LANES rays of a row. Outside of `changing` they are those of its first and last layer.
 */
static void find_costs(const sv_wall_layout *l, __global const ushort *fine, uint row, uint x,
                       extent_t changing, __global u16l *costs) {
    const uint beside = cell_beside(row, l->cells[1]);
    for (uint z = changing.from; z < changing.to; z++)
        costs[z] = between_cells(fine + fine_row(l, z, row / 2) + x * HALF,
                                 fine + fine_row(l, z, beside) + x * HALF);
    const u16l before = costs[changing.from], behind = costs[changing.to - 1];
    for (uint z = 0; z < changing.from; z++) costs[z] = before;
    for (uint z = changing.to; z < l->layers; z++) costs[z] = behind;
}

/* One work item per row of rays. `scratch`: words of 32 bits, scratch_words a row. `planes`: the planes of
 * the layers, and of the ends around them. */
__kernel void wall_minimum(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                           __global const ushort *restrict fine, __global ushort *restrict rays,
                           __global uint *restrict scratch, __global float *restrict planes) {
    const uint row = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    __global u16l *costs = (__global u16l *)(scratch + (size_t)row * scratch_words);
    const extent_t changing = changing_near(&l, rays, row / 2, l.reach_y + 1);
    for (uint x = 0; x < vectors_of(&l); x++) {
        find_costs(&l, fine, row, x, changing, costs);
        find_minima(&l, costs, changing, planes + plane_row(&l, 0, row) + x * LANES);
    }
}
