/*
 * Cost volume: how bright it is around a bin, and where the wall and the back of the sac lie. Sums and maxima
 * lie as the bins do.
 */
#ifndef SV_METHOD_COST_CLH
#include "method_cost.clh"
#endif

/* Rays of a padded row at most, and zeros on either side of it for what reads beyond. */
#define MOST_COLUMNS (2 * SV_COST_RAYS)
#define MARGIN       SV_LANES
#define MOST_BESIDE  6

/* The bins `from` of 16 rays, if the label exists (mask 0: it does not). */
static ushort16 bins_at(__global const uchar *from, ushort mask) {
    return convert_ushort16(vload16(0, from)) & (ushort16)(mask);
}

/* The bins of one row, with those of the labels before and behind and those of the rays beside them. */
static void sum_row(const cost_layout *l, uint label, __global const uchar *row, ushort *to) {
    const size_t plane = (size_t)l->rows * l->padded_columns;
    const bool first = label == 0, last = label + 1 == l->labels;
    __global const uchar *before = first ? row : row - plane, *behind = last ? row : row + plane;
    const ushort with_before = first ? 0 : 0xffff, with_behind = last ? 0 : 0xffff;
    ushort16 left = (ushort16)(0), here = left, right = left;
    for (uint x = 0; x < l->padded_columns + SV_LANES; x += SV_LANES) {
        left = here;
        here = right;
        right = (ushort16)(0);
        if (x < l->padded_columns)
            right = bins_at(row + x, 0xffff) + bins_at(before + x, with_before) +
                    bins_at(behind + x, with_behind);
        if (x == 0) continue;
        const ushort16 lower = (ushort16)(left.sf, here.s01234567, here.s89ab, here.scde);
        const ushort16 upper = (ushort16)(here.s1234, here.s56789abc, here.sdef, right.s0);
        vstore16(lower + here + upper, 0, to + x - SV_LANES);
    }
    for (uint x = l->columns; x < l->padded_columns; x++) to[x] = 0;
}

/* One work item per label: sums over 3 x 3 x 3 bins, 0 beyond the volume. */
__kernel void cost_sums(cost_layout l, __global const uchar *restrict bins, __global ushort *restrict sums) {
    const uint label = (uint)get_global_id(0);
    const size_t plane = (size_t)label * l.rows * l.padded_columns;
    ushort rows[3][MOST_COLUMNS];
    for (uint x = 0; x < l.padded_columns; x++) rows[2][x] = rows[1][x] = 0;
    sum_row(&l, label, bins + plane, rows[0]);
    for (uint y = 0; y < l.rows; y++) {
        const size_t at = plane + (size_t)y * l.padded_columns;
        ushort *next = rows[(y + 1) % 3];
        if (y + 1 < l.rows) sum_row(&l, label, bins + at + l.padded_columns, next);
        for (uint x = 0; x < l.padded_columns; x += SV_LANES) {
            ushort16 sum = vload16(0, rows[y % 3] + x) + vload16(0, rows[(y + 2) % 3] + x);
            if (y + 1 < l.rows) sum += vload16(0, next + x);
            vstore16(sum, 0, sums + at + x);
        }
    }
}

/* The largest sums of a row within `dilate` labels, then of those within `beside` rays of the row. `wide`:
 * room for a row between zeros. */
static void brightest_row(const cost_layout *l, uint label, __global const ushort *row, ushort *wide,
                          ushort *to) {
    const size_t plane = (size_t)l->rows * l->padded_columns;
    const uint before = min(label, l->dilate), behind = min(l->labels - 1 - label, l->dilate);
    row -= before * plane;
    for (uint x = 0; x < l->padded_columns; x += SV_LANES) {
        ushort16 most = vload16(0, row + x);
        for (uint k = 1; k <= before + behind; k++) most = max(most, vload16(0, row + k * plane + x));
        vstore16(most, 0, wide + MARGIN + x);
    }
    for (uint x = 0; x < l->padded_columns; x += SV_LANES) {
        const ushort *from = wide + MARGIN + x;
        ushort16 most = vload16(0, from);
        for (uint k = 1; k <= l->beside; k++)
            most = max(most, max(vload16(0, from - k), vload16(0, from + k)));
        vstore16(most, 0, to + x);
    }
}

/* One work item per label: the largest of the sums within `beside` rays and `dilate` bins. */
__kernel void cost_nearby(cost_layout l, __global const ushort *restrict sums,
                          __global ushort *restrict nearby) {
    const uint label = (uint)get_global_id(0), span = 2 * l.beside + 1;
    const size_t plane = (size_t)label * l.rows * l.padded_columns;
    /* Of the rows around one; a row beyond the volume is zeros. */
    ushort rows[2 * MOST_BESIDE + 1][MOST_COLUMNS];
    ushort wide[MOST_COLUMNS + 2 * MARGIN];
    for (uint x = 0; x < MOST_COLUMNS + 2 * MARGIN; x++) wide[x] = 0;
    for (uint k = 0; k < span; k++)
        for (uint x = 0; x < l.padded_columns; x++) rows[k][x] = 0;
    for (uint y = 0; y < l.rows + l.beside; y++) {
        ushort *newest = rows[y % span];
        if (y < l.rows)
            brightest_row(&l, label, sums + plane + (size_t)y * l.padded_columns, wide, newest);
        else
            for (uint x = 0; x < l.padded_columns; x++) newest[x] = 0;
        if (y < l.beside) continue;
        __global ushort *to = nearby + plane + (size_t)(y - l.beside) * l.padded_columns;
        for (uint x = 0; x < l.padded_columns; x += SV_LANES) {
            ushort16 most = vload16(0, rows[0] + x);
            for (uint k = 1; k < span; k++) most = max(most, vload16(0, rows[k] + x));
            vstore16(most, 0, to + x);
        }
        for (uint x = l.columns; x < l.padded_columns; x++) to[x] = 0;
    }
}

/* What the walk along a cell's rays knows, for a row of columns; only the first of every cell counts. */
typedef struct {
    uchar run[MOST_COLUMNS];    /* mostly fluid bins behind tissue */
    uchar behind[MOST_COLUMNS]; /* 255: behind tissue */
    uchar wall[MOST_COLUMNS], back[MOST_COLUMNS];
} walk_t;

/* Numbers of scanned and of fluid rays of a cell's rows in every column, and zeros behind them. */
typedef struct {
    uchar scanned[MOST_COLUMNS + MARGIN], fluid[MOST_COLUMNS + MARGIN];
} crowd_t;

static void count_rows(const cost_layout *l, __global const uchar *bins, uint rows, uchar level,
                       crowd_t *crowd) {
    for (uint x = 0; x < l->padded_columns; x += SV_LANES) {
        uchar16 scanned = (uchar16)(0), tissue = scanned;
        for (uint y = 0; y < rows; y++) {
            const uchar16 v = vload16(0, bins + y * l->padded_columns + x);
            scanned -= as_uchar16(v > (uchar16)(0));
            tissue -= as_uchar16(v > (uchar16)(level));
        }
        vstore16(scanned, 0, crowd->scanned + x);
        vstore16(scanned - tissue, 0, crowd->fluid + x);
    }
}

/* Sums of `block` neighbours: at most 8 x 8. */
static uchar16 cell_sums(const uchar *counts, uint block) {
    uchar16 sum = vload16(0, counts);
    for (uint k = 1; k < block; k++) sum += vload16(0, counts + k);
    return sum;
}

static void step(const cost_layout *l, uint bin, const crowd_t *crowd, uint x, walk_t *walk) {
    const uchar16 none = (uchar16)((uchar)l->labels), solid = (uchar16)((uchar)l->solid);
    const uchar16 scanned = cell_sums(crowd->scanned + x, l->block);
    const uchar16 fluid = cell_sums(crowd->fluid + x, l->block);
    const uchar16 some = as_uchar16(scanned > (uchar16)(0));
    const uchar16 mostly = some & as_uchar16(fluid + fluid >= scanned);
    const uchar16 behind = vload16(0, walk->behind + x), run = vload16(0, walk->run + x);
    const uchar16 wall = vload16(0, walk->wall + x), back = vload16(0, walk->back + x);

    const uchar16 longer = (run + (behind & (uchar16)(1))) & mostly;
    const uchar16 opens = as_uchar16(longer == solid) & as_uchar16(wall == none);
    const uchar16 closes = some & ~mostly & as_uchar16(wall < none) & as_uchar16(run >= solid);
    vstore16(longer, 0, walk->run + x);
    vstore16(behind | (some & ~mostly), 0, walk->behind + x);
    vstore16((wall & ~opens) | ((uchar16)((uchar)(bin + 1 - l->solid)) & opens), 0, walk->wall + x);
    vstore16((back & ~closes) | ((uchar16)((uchar)bin) & closes), 0, walk->back + x);
}

/* One work item per row of cells: the cells' own walls (labels: none), then their backs (0: none). A bin is
 * mostly fluid if at least half of a cell's scanned rays are fluid there. */
__kernel void cost_walls_own(cost_layout l, __global const uchar *restrict bins,
                             __global const uint *restrict info, __global uchar *restrict own) {
    const uint cell_row = (uint)get_global_id(0), y0 = cell_row * l.block;
    const uint rows = min(l.block, l.rows - y0);
    const uchar level = (uchar)info[SV_COST_INFO_LEVEL];
    walk_t walk;
    crowd_t crowd;
    for (uint x = 0; x < MOST_COLUMNS + MARGIN; x++) crowd.scanned[x] = crowd.fluid[x] = 0;
    for (uint x = 0; x < MOST_COLUMNS; x++) {
        walk.run[x] = walk.behind[x] = walk.back[x] = 0;
        walk.wall[x] = (uchar)l.labels;
    }
    for (uint bin = 0; bin < l.labels; bin++) {
        count_rows(&l, bins + ((size_t)bin * l.rows + y0) * l.padded_columns, rows, level, &crowd);
        for (uint x = 0; x < l.padded_columns; x += SV_LANES) step(&l, bin, &crowd, x, &walk);
    }
    for (uint cell = 0; cell < l.cells_x; cell++) {
        own[cell_row * l.cells_x + cell] = walk.wall[cell * l.block];
        own[(l.cells_y + cell_row) * l.cells_x + cell] = walk.back[cell * l.block];
    }
}

/* The values of a window of cells, counted one by one and by sixteens. */
typedef struct {
    uchar one[256], sixteen[16];
    uint all;
} ranks_t;

/* Column x of the cells' rows y0 .. y1 - 1, but for the value `none`, enters the window or leaves it. */
static void shift_ranks(const cost_layout *l, __global const uchar *own, uint x, uint y0, uint y1, uchar none,
                        int change, ranks_t *ranks) {
    for (uint y = y0; y < y1; y++) {
        const uchar value = own[y * l->cells_x + x];
        if (value == none) continue;
        ranks->one[value] = (uchar)(ranks->one[value] + change);
        ranks->sixteen[value / 16] = (uchar)(ranks->sixteen[value / 16] + change);
        ranks->all = (uint)((int)ranks->all + change);
    }
}

/* The value that `below` others lie before; there are more. */
static uchar value_at(const ranks_t *ranks, uint below) {
    uint value = 0, before = 0;
    while (before + ranks->sixteen[value / 16] <= below) {
        before += ranks->sixteen[value / 16];
        value += 16;
    }
    while (before + ranks->one[value] <= below) before += ranks->one[value++];
    return (uchar)value;
}

/* A row of cells: of the values around each but `none`, the one with `rank` tenths of the others below it. */
static void rank_row(const cost_layout *l, __global const uchar *own, uint cell_row, uchar none, uint rank,
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
__kernel void cost_walls(cost_layout l, __global const uchar *restrict own, __global uchar *restrict walls) {
    const uint cell_row = (uint)get_global_id(0), cells = l.cells_x * l.cells_y;
    const uchar none = (uchar)l.labels;
    rank_row(&l, own, cell_row, none, 2, 0, walls);
    rank_row(&l, own + cells, cell_row, 0, 1, none, walls + cells);
}
