/* SPDX-License-Identifier: MIT */
/*
 * Cost volume, the volume: what the rays of a cell pay for every label, and the lateral Gaussian along x. A
 * cell is SV_COST_VALUES floats in a row: its labels, then its rays.
 */
#ifndef SV_METHOD_COST_CLH
#include "cost/cost.clh"
#endif
#ifndef SV_COST_BRIGHTNESS_CLH
#include "cost/cost_brightness.clh"
#endif
#ifndef SV_COST_TILE_CLH
#include "cost/cost_tile.clh"
#endif
#ifndef SV_COST_TILE_PASSES_CLH
#include "cost/cost_tile_passes.clh"
#endif

/* Returns the wall or back of the cell that each of 16 rays is in. */
static short16 cell_values(const sv_cost_layout *l, __global const uchar *row, uint x) {
    short16 lanes;
    for (uint i = 0; i < SV_LANES; i++) ((short *)&lanes)[i] = row[min((x + i) / l->block, l->cells_x - 1)];
    return lanes;
}

/* Returns the bin in front of which no ray with a wall can have an interval. */
static uint first_bin(const sv_cost_layout *l, short16 wall) {
    const short16 from =
        select((short16)((short)l->labels), max(wall - (short)l->solid, (short16)(0)), wall > (short16)(0));
    const short *lanes = (const short *)&from;
    short first = lanes[0];
    for (uint i = 1; i < SV_LANES; i++) first = min(first, lanes[i]);
    return (uint)first;
}

/* Adds lane i of `value` to the cell of ray x + i. */
static void to_cells(const sv_cost_layout *l, __global float *cells, uint slot, uint x, float16 value) {
    const uint count = min((uint)SV_LANES, l->columns - x);
    const float *lanes = (const float *)&value;
    for (uint i = 0; i < count; i++) cells[(x + i) / l->block * SV_COST_VALUES + slot] += lanes[i];
}

/* Transposes 16 x 16 values: four times the halves of the vectors are interleaved. */
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

/* Adds the costs of 16 rays to their cells. */
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

/* The state that the rows of cells of a work item share. */
typedef struct {
    __global const uchar *walls, *backs;
    __global bin16_t *tile;
    __global float *volume;
    float unit; /* see backward_runs */
    short bone;
    bins16_t w;
} gather_t;

/* Gathers a row of cells. `counts`: its scanned rays, and those with a fluid interval. */
static void gather_row(const sv_cost_layout *l, const tile_source_t *s, gather_t *g, uint cell_row,
                       __global uint *counts) {
    __global float *cells = cell_at(g->volume, l, 0, cell_row);
    __global const uchar *wall = g->walls + cell_row * l->cells_x, *back = g->backs + cell_row * l->cells_x;
    uint scanned_rays = 0, open_rays = 0;
    for (size_t i = 0; i < (size_t)l->cells_x * SV_COST_VALUES; i++) cells[i] = 0.0f;
    for (uint x = 0; x < l->columns; x += SV_LANES) {
        const uint lanes = min((uint)SV_LANES, l->columns - x);
        float16 weight = (float16)(0.0f), open = weight;
        short16 scanned[MAX_BLOCK];
        rays_t r;
        r.wall = cell_values(l, wall, x);
        r.back = cell_values(l, back, x);
        const bool walled = any_lane(r.wall > (short16)(0));
        if (walled) {
            r.from = first_bin(l, r.wall);
            r.end = max(min(fill_tile(l, s, x, r.from, g->tile, scanned) + 1, l->labels), r.from);
        } else
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

/* True if a row of cells has walls; the vectors of its rays with walls widen `ring`. */
static bool find_walls(const sv_cost_layout *l, __global const uchar *walls, ring_t *ring) {
    bool found = false;
    for (uint x = 0; x < l->cells_x; x++) {
        if (walls[x] == 0) continue;
        const uint end = x + 1 == l->cells_x ? l->padded_columns : (x + 1) * l->block;
        ring->from = min(ring->from, x * l->block / SV_LANES);
        ring->end = max(ring->end, (end + SV_LANES - 1) / SV_LANES);
        found = true;
    }
    return found;
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
    ring_t ring = {sums + first, brightest + first, l.padded_columns / SV_LANES, 0};
    const uint bright = info[SV_COST_INFO_BRIGHT];
    gather_t g;
    g.walls = walls;
    g.backs = walls + (size_t)l.cells_x * l.cells_y;
    g.tile = tiles + (size_t)item * l.block * l.labels;
    g.volume = volume;
    g.unit = 1.0f / ((float)SV_COST_NEIGHBOURS * (float)bright);
    g.bone = (short)((SV_COST_BONE * SV_COST_NEIGHBOURS * bright + 1) / 2);
    for (uint bin = 0; bin < SV_COST_LABELS; bin++) g.w.cost[bin] = (float16)(0.0f);
    for (uint cell_row = item * band; cell_row < end; cell_row++) /* so that all rows of the ring are alike */
        (void)find_walls(&l, walls + cell_row * l.cells_x, &ring);
    uint made = 0; /* rows of rays up to this one are computed */
    for (uint cell_row = item * band; cell_row < end; cell_row++) {
        const uint y0 = cell_row * l.block;
        if (find_walls(&l, walls + cell_row * l.cells_x, &ring)) {
            const uint from = max(made, y0 - min(y0, l.lateral));
            made = min(y0 + l.block + l.lateral, l.rows);
            if (from < made) make_rows(&l, bins, from, made, &ring);
        }
        const tile_source_t source = tile_source(&l, bins, &ring, y0, info[SV_COST_INFO_LEVEL]);
        gather_row(&l, &source, &g, cell_row, counts + 2 * cell_row);
    }
}

/* One work item: decides whether the frame has a surface. */
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
