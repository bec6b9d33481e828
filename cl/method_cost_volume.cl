/*
 * Cost volume, the volume: what 16 rays pay for every label, summed over the rays of a cell, and the lateral
 * Gaussian along x. A cell is SV_COST_VALUES floats in a row: its labels, then its numbers of rays.
 */
#ifndef SV_METHOD_COST_CLH
#include "method_cost.clh"
#endif

/* What is known of 16 rays. Masks are -1 or 0. */
typedef struct {
    int16 place, wall;
    float16 bone, weight; /* 1 for a scanned ray, else 0 */
} rays_t;

enum { FAR_AWAY = 1000 }; /* bins; further than any tau */

/* Length so far of the fluid run that every bin is in; 0 outside. */
static void walk_runs(__global const uchar *bins, size_t plane, uint labels, int16 level, int16 *runs) {
    int16 seen = (int16)(0), run = (int16)(0);
    for (uint bin = 0; bin < labels; bin++) {
        const int16 v = convert_int16(vload16(0, bins + bin * plane));
        const int16 tissue = v > level;
        seen |= tissue;
        run = (run + 1) & (v > (int16)(0)) & ~tissue & seen;
        runs[bin] = run;
    }
}

/* From the back: `runs` becomes the distance in bins to the fluid behind (0 inside it), `own` marks the
 * interval before the maximum. */
static void walk_back(uint labels, int16 gap, int16 place, int16 *runs, int16 *own) {
    int16 total = (int16)(0), behind = (int16)(FAR_AWAY);
    int16 inside = (int16)(0), over = (int16)(0);
    for (uint bin = labels; bin-- > 0;) {
        const int16 run = runs[bin];
        total = select(run, total, total > (int16)(0)) & (run > (int16)(0));
        const int16 open = total >= gap;
        behind = select(behind + 1, (int16)(0), open);
        over |= inside & ~open;
        inside = open & ~over & ((int16)((int)bin) < place);
        own[bin] = inside;
        runs[bin] = behind;
    }
}

/* Adds the costs of 16 rays to `sums`. */
static void add_costs(__global const uchar *bins, size_t plane, const cost_layout *l, int16 level,
                      const rays_t *r, float16 *sums) {
    int16 behind[SV_COST_LABELS], own[SV_COST_LABELS];
    walk_runs(bins, plane, l->labels, level, behind);
    walk_back(l->labels, (int16)((int)l->gap),
              select((int16)(0), r->place, r->place < (int16)((int)l->labels)), behind, own);
    int16 before = (int16)(FAR_AWAY);
    float16 tissue = (float16)(0.0f);
    const float16 per_bin = (float16)(1.0f / (SV_COST_TAU * l->scale)),
                  most = (float16)(SV_COST_TISSUES * l->scale);
    const float16 beyond = SV_COST_BEHIND * r->bone, other = SV_COST_OTHER * r->bone;
    const float gamma = SV_COST_TISSUE / l->scale;
    for (uint bin = 0; bin < l->labels; bin++) {
        const int16 at = (int16)((int)bin);
        before = (before + 1) & (behind[bin] != (int16)(0));
        const int16 bins_away = min(before, behind[bin]);
        const float16 distance = max(convert_float16(bins_away) - 0.5f, (float16)(0.0f));
        float16 cost = min(distance * per_bin, (float16)(1.0f));
        cost += select((float16)(0.0f), beyond, at > r->place);
        cost += select(other, (float16)(0.0f), own[bin]);
        const int16 v = convert_int16(vload16(0, bins + bin * plane));
        const float16 here = select((float16)(0.0f), (float16)(1.0f), (v > level) & (at >= r->wall));
        cost += gamma * min(tissue + 0.5f * here, most);
        tissue += here;
        sums[bin] += cost * r->weight;
    }
}

/* First fluid bin of every cell of a row, for each of its rays; 0 for cells that have none. */
static void cell_walls(const cost_layout *l, __global const uchar *first, uint y0, uint y1,
                       __global uchar *restrict walls) {
    for (uint x0 = 0; x0 < l->width; x0 += l->block) {
        const uint x1 = min(x0 + l->block, l->width);
        uint wall = l->labels;
        for (uint y = y0; y < y1; y++)
            for (uint x = x0; x < x1; x++) wall = min(wall, (uint)first[(size_t)y * l->padded_width + x]);
        for (uint x = x0; x < x1; x++) walls[x] = (uchar)(wall == l->labels ? 0 : wall);
    }
    for (uint x = l->width; x < l->padded_width; x++) walls[x] = 0;
}

static rays_t load_rays(const cost_layout *l, __global const uchar *rays, size_t plane, size_t at, uint x,
                        __global const uchar *walls, __global const float *bone) {
    float lanes[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) lanes[i] = bone[rays[SV_COST_MAXIMUM * plane + at + i]];
    rays_t r;
    r.place = convert_int16(vload16(0, rays + SV_COST_PLACE * plane + at));
    r.wall = convert_int16(vload16(0, walls + x));
    r.bone = vload16(0, lanes);
    r.weight = convert_float16(vload16(0, rays + SV_COST_SCANNED * plane + at));
    const int16 inside = LANE_NUMBERS + (int16)((int)x) < (int16)((int)l->width);
    r.weight = select((float16)(0.0f), r.weight, inside);
    return r;
}

/* One work item per row of cells. `walls`: a padded row for each. */
__kernel void cost_gather(cost_layout l, __global const uchar *restrict bins,
                          __global const uchar *restrict rays, __global const uint *restrict info,
                          __global const float *restrict bone, __global uchar *restrict walls,
                          __global float *restrict volume) {
    const uint cell_row = (uint)get_global_id(0);
    if (!info[SV_COST_INFO_WANTED]) return;
    const size_t plane = (size_t)l.padded_width * l.height;
    const int16 level = (int16)((int)info[SV_COST_INFO_LEVEL]);
    const uint y0 = cell_row * l.block, y1 = min(y0 + l.block, l.height);
    __global uchar *wall_row = walls + (size_t)cell_row * l.padded_width;
    __global float *cells = cell_at(volume, &l, 0, cell_row);
    for (size_t i = 0; i < (size_t)l.cells_x * SV_COST_VALUES; i++) cells[i] = 0.0f;
    cell_walls(&l, rays + SV_COST_FIRST * plane, y0, y1, wall_row);
    for (uint x = 0; x < l.width; x += SV_LANES) {
        float16 sums[SV_COST_LABELS];
        float16 scanned = (float16)(0.0f), open = scanned;
        for (uint bin = 0; bin < l.labels; bin++) sums[bin] = (float16)(0.0f);
        for (uint y = y0; y < y1; y++) {
            const size_t at = (size_t)y * l.padded_width + x;
            const rays_t r = load_rays(&l, rays, plane, at, x, wall_row, bone);
            add_costs(bins + at, plane, &l, level, &r, sums);
            const int16 first = convert_int16(vload16(0, rays + SV_COST_FIRST * plane + at));
            scanned += r.weight;
            open += select((float16)(0.0f), r.weight, first < (int16)((int)l.labels));
        }
        float lanes[SV_LANES];
        const uint count = min((uint)SV_LANES, l.width - x);
        for (uint value = 0; value < l.labels + 2; value++) {
            const uint slot = value < l.labels ? value : SV_COST_WEIGHT + value - l.labels;
            vstore16(value < l.labels ? sums[value] : slot == SV_COST_WEIGHT ? scanned : open, 0, lanes);
            for (uint i = 0; i < count; i++) cells[(x + i) / l.block * SV_COST_VALUES + slot] += lanes[i];
        }
    }
}

/* One work item per row of cells: the Gaussian along x. weight.s0 .. s6: at 0 .. 6 cells. */
__kernel void cost_blur(cost_layout l, float8 weight, __global const uint *restrict info,
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
            vstore16(sum, 0, cell_at(blurred, &l, (uint)x, y) + v);
        }
    }
}
