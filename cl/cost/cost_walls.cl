/* SPDX-License-Identifier: MIT */
/* Cost volume: where the wall and the back of the sac lie. */
#ifndef SV_METHOD_COST_CLH
#include "cost/cost.clh"
#endif

static uchar16 counts_from(const uchar *p) {
    return ((const bytes_unaligned *)p)->v;
}

/* The state of a pass along the rays of cells, for 16 columns; only the first column of every cell counts.
 * */
typedef struct {
    uchar16 run;    /* mostly fluid bins behind tissue */
    uchar16 behind; /* 255: behind tissue */
    uchar16 wall, back;
} wall_scan_t;

/* The numbers of scanned and of fluid rays of a cell's rows in every column, and zeros behind them. */
typedef struct {
    uchar16 scanned[MAX_VECTORS + 1], fluid[MAX_VECTORS + 1];
} row_counts_t;

static void count_rows(const sv_cost_layout *l, __global const uchar16 *bins, uint rows, uchar level,
                       row_counts_t *counts) {
    const uint vectors = l->padded_columns / SV_LANES, stride = l->labels * vectors;
    for (uint x = 0; x < vectors; x++) {
        uchar16 scanned = (uchar16)(0), tissue = scanned;
        for (uint y = 0; y < rows; y++) {
            const uchar16 v = bins[y * stride + x];
            scanned -= as_uchar16(v > (uchar16)(0));
            tissue -= as_uchar16(v > (uchar16)(level));
        }
        counts->scanned[x] = scanned;
        counts->fluid[x] = scanned - tissue;
    }
}

/* Sums up `block` neighbours: at most 8 x 8. */
static uchar16 cell_sums(const uchar16 *counts, uint block) {
    uchar16 sum = *counts;
    for (uint k = 1; k < block; k++) sum += counts_from((const uchar *)counts + k);
    return sum;
}

static void wall_step(const sv_cost_layout *l, uint bin, uchar16 scanned, uchar16 fluid, wall_scan_t *walk) {
    const wall_scan_t w = *walk;
    const uchar16 none = (uchar16)((uchar)l->labels), solid = (uchar16)((uchar)l->solid);
    const uchar16 some = as_uchar16(scanned > (uchar16)(0));
    const uchar16 mostly = some & as_uchar16(fluid + fluid >= scanned);
    const uchar16 tissue = some & ~mostly;
    const uchar16 run = (w.run + (w.behind & (uchar16)(1))) & mostly;
    const uchar16 opens = as_uchar16(run == solid) & as_uchar16(w.wall == none);
    const uchar16 closes = tissue & as_uchar16(w.wall < none) & as_uchar16(w.run >= solid);
    walk->run = run;
    walk->behind = w.behind | tissue;
    walk->wall = (w.wall & ~opens) | ((uchar16)((uchar)(bin + 1 - l->solid)) & opens);
    walk->back = (w.back & ~closes) | ((uchar16)((uchar)bin) & closes);
}

/* One work item per row of cells: the cells' own walls (labels: none), then their backs (0: none). A bin is
 * mostly fluid if at least half of a cell's scanned rays are fluid there. */
__kernel void cost_walls_own(sv_cost_layout l, __global const uchar *restrict bins,
                             __global const uint *restrict info, __global uchar *restrict own) {
    const uint cell_row = (uint)get_global_id(0), y0 = cell_row * l.block;
    const uint rows = min(l.block, l.rows - y0), vectors = l.padded_columns / SV_LANES;
    const uchar level = (uchar)info[SV_COST_INFO_LEVEL];
    wall_scan_t walk[MAX_VECTORS];
    row_counts_t counts;
    counts.scanned[vectors] = counts.fluid[vectors] = (uchar16)(0);
    for (uint x = 0; x < vectors; x++) {
        walk[x].run = walk[x].behind = walk[x].back = (uchar16)(0);
        walk[x].wall = (uchar16)((uchar)l.labels);
    }
    for (uint bin = 0; bin < l.labels; bin++) {
        count_rows(&l, (__global const uchar16 *)(bins + bins_at(&l, y0, bin)), rows, level, &counts);
        for (uint x = 0; x < vectors; x++)
            wall_step(&l, bin, cell_sums(counts.scanned + x, l.block), cell_sums(counts.fluid + x, l.block),
                      walk + x);
    }
    for (uint cell = 0; cell < l.cells_x; cell++) {
        const wall_scan_t *w = walk + cell * l.block / SV_LANES;
        const uint lane = cell * l.block % SV_LANES;
        own[cell_row * l.cells_x + cell] = ((const uchar *)&w->wall)[lane];
        own[(l.cells_y + cell_row) * l.cells_x + cell] = ((const uchar *)&w->back)[lane];
    }
}

/* A histogram of the values of a window of cells, by ones and by sixteens. */
typedef struct {
    uchar one[256], sixteen[16];
    uint all;
} ranks_t;

/* Adds column x of the cells' rows y0 .. y1 - 1 to the window or removes it, but for the value `none`. */
static void shift_ranks(const sv_cost_layout *l, __global const uchar *own, uint x, uint y0, uint y1,
                        uchar none, int change, ranks_t *ranks) {
    for (uint y = y0; y < y1; y++) {
        const uchar value = own[y * l->cells_x + x];
        if (value == none) continue;
        ranks->one[value] = (uchar)(ranks->one[value] + change);
        ranks->sixteen[value / 16] = (uchar)(ranks->sixteen[value / 16] + change);
        ranks->all = (uint)((int)ranks->all + change);
    }
}

/* Returns the value that has `below` others below it; there are more. */
static uchar value_at(const ranks_t *ranks, uint below) {
    uint value = 0, before = 0;
    while (before + ranks->sixteen[value / 16] <= below) {
        before += ranks->sixteen[value / 16];
        value += 16;
    }
    while (before + ranks->one[value] <= below) before += ranks->one[value++];
    return (uchar)value;
}

/* Rank filter over a row of cells: of the values around each but `none`, the one with `rank` tenths of the
 * others below it. */
static void rank_row(const sv_cost_layout *l, __global const uchar *own, uint cell_row, uchar none, uint rank,
                     uchar otherwise, __global uchar *to) {
    const uint y0 = cell_row - min(cell_row, (uint)SV_COST_WINDOW);
    const uint y1 = min(cell_row + SV_COST_WINDOW + 1, l->cells_y);
    ranks_t ranks;
    for (uint i = 0; i < 256; i++) ranks.one[i] = 0;
    for (uint i = 0; i < 16; i++) ranks.sixteen[i] = 0;
    ranks.all = 0;
    for (uint x = 0; x < min((uint)SV_COST_WINDOW, l->cells_x); x++)
        shift_ranks(l, own, x, y0, y1, none, 1, &ranks);
    for (uint x = 0; x < l->cells_x; x++) {
        if (x + SV_COST_WINDOW < l->cells_x) shift_ranks(l, own, x + SV_COST_WINDOW, y0, y1, none, 1, &ranks);
        if (x > SV_COST_WINDOW) shift_ranks(l, own, x - SV_COST_WINDOW - 1, y0, y1, none, -1, &ranks);
        to[cell_row * l->cells_x + x] =
            ranks.all == 0 ? otherwise : value_at(&ranks, (ranks.all - 1) * rank / 10);
    }
}

/* One work item per row of cells: the walls by rank (0 if there is none around), then the backs (labels). */
__kernel void cost_walls(sv_cost_layout l, __global const uchar *restrict own,
                         __global uchar *restrict walls) {
    const uint cell_row = (uint)get_global_id(0), cells = l.cells_x * l.cells_y;
    const uchar none = (uchar)l.labels;
    rank_row(&l, own, cell_row, none, 2, 0, walls);
    rank_row(&l, own + cells, cell_row, 0, 1, none, walls + cells);
}
