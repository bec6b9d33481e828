/* SPDX-License-Identifier: MIT */
/*
 * Levels relative to the threshold around them: sums and counts of bright blocks over windows of cells, the
 * mean brightness there, and what each block is multiplied by. Then the rays that begin with a few dark
 * layers are counted.
 */
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
#endif

/* Cells of a row in whole vectors of HALF. */
static uint vector_cells_of(const sv_wall_layout *l) {
    return (l->cells[0] + HALF - 1) / HALF * HALF;
}

/* Adds neighbouring bytes. */
static u16h sum_pairs(u8l values) {
    const u16h pairs = REINTERPRET(values, u16h);
    return (pairs & (ushort)255) + (pairs >> (ushort)8);
}

/* Returns the sum and the count of the bright blocks of HALF cells, in one word each. `levels`: of the upper
 * one of their rows. */
static u32h bright_blocks(__global const uchar *levels, size_t row_pitch, u8l threshold) {
    const u8l above = *(__global const u8l *)levels, below = *(__global const u8l *)(levels + row_pitch);
    const u8l bright_above = AS_U8(above > threshold), bright_below = AS_U8(below > threshold);
    const u16h sums = sum_pairs(above & bright_above) + sum_pairs(below & bright_below);
    const u16h counts = sum_pairs(bright_above & (uchar)1) + sum_pairs(bright_below & (uchar)1);
    return HALF_TO_U32(sums) + (HALF_TO_U32(counts) << (uint)SV_WALL_SUM_BITS);
}

/* One work item per row of cells: the bright blocks of every cell and of those near it in its row. */
__kernel void wall_bright(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                          __global const uchar *restrict levels, __global ushort *restrict rays,
                          __global uint *restrict scratch, __global uint *restrict windows) {
    const uint row = (uint)get_global_id(0), cells = vector_cells_of(&l),
               pitch = padded_cells_of(&l) + 2 * MARGIN;
    const int reach = (int)l.window[0];
    const u8l threshold = (u8l)((uchar)info[SV_WALL_INFO_THRESHOLD]);
    const size_t row_pitch = level_row(&l, 0, 1) - level_row(&l, 0, 0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    /* two lines alternate, for a vector that was just stored is slow to load in parts */
    __global uint *lines = scratch + (size_t)row * scratch_words;
    for (uint x = 0; x < 2 * pitch; x++) lines[x] = 0;
    lines += MARGIN;
    const extent_t scanned = extent_of_row(&l, rays, row);
    clear_others(&l, scanned, (__global uchar *)(windows + cell_row(&l, 0, row)),
                 padded_cells_of(&l) * sizeof *windows);
    for (uint z = scanned.from; z <= scanned.to; z++) {
        __global uint *to = lines + z % 2 * pitch, *from = lines + (z + 1) % 2 * pitch;
        for (uint x = 0; z < scanned.to && x < cells; x += HALF)
            *(__global u32h *)(to + x) =
                bright_blocks(levels + level_row(&l, z, 2 * row) + 2 * x, row_pitch, threshold);
        for (int x = 0; z > scanned.from && x < (int)cells; x += HALF) {
            u32h sum = *(__global const u32h *)(from + x);
            for (int k = 1; k <= reach; k++)
                sum += ((__global const u32h_unaligned *)(from + x - k))->v +
                       ((__global const u32h_unaligned *)(from + x + k))->v;
            *(__global u32h *)(windows + cell_row(&l, z - 1, row) + x) = sum;
        }
    }
}

/* Sums over the windows of a layer in rows near `row`. */
static u32h sum_rows_near(const sv_wall_layout *l, __global const uint *windows, uint z, uint row, uint x) {
    const uint from = row - min(row, l->window[1]), to = min(row + l->window[1], l->cells[1] - 1);
    const size_t pitch = cell_row(l, 0, 1);
    u32h sum = (u32h)(0);
    windows += cell_row(l, z, from) + x;
    for (uint y = from; y <= to; y++, windows += pitch) sum += *(__global const u32h *)windows;
    return sum;
}

/* Divides integers of up to 24 bits, rounding down. The quotient of float32 is at most one away. */
static u32h quotient(u32h value, u32h by) {
    const i32h about = HALF_F32_TO_I32(HALF_TO_F32(value) / HALF_TO_F32(by));
    const i32h divisor = REINTERPRET(by, i32h), rest = REINTERPRET(value, i32h) - about * divisor;
    const i32h less = rest < (i32h)(0), more = rest >= divisor; /* -1 if so */
    return REINTERPRET(about + less - more, u32h);
}

/* The bright blocks within a window of HALF cells. */
typedef struct {
    u32h sum, count;
} bright_t;

/* Looks up what the levels of HALF cells are multiplied by. */
static u32h gains_of(const sv_wall_layout *l, __global const uint *info, const bright_t *w) {
    __global const uint *table = info + SV_WALL_INFO_GAINS;
    const uint all = l->bright_blocks * info[SV_WALL_INFO_BRIGHT] / (SV_WALL_LEVEL_ONE / SV_WALL_BRIGHT_ONE);
    const u32h mean = quotient(w->sum * (uint)SV_WALL_BRIGHT_ONE + all, w->count + l->bright_blocks);
    const u32h bright = MAXIMUM(mean, (u32h)(info[SV_WALL_INFO_THRESHOLD] * SV_WALL_BRIGHT_ONE));
    u32h gains;
    TABLE_LOADS
    for (uint i = 0; i < HALF; i++) /* signed indices need no wider ones */
        ((uint *)&gains)[i] = table[((const int *)&bright)[i]];
    return gains;
}

static u32h relative_of(u32h levels, u32h gains) {
    const u32h relative = levels * gains >> (uint)SV_WALL_GAIN_BITS;
    return MINIMUM(relative, (u32h)(255));
}

/* Multiplies the levels of the rays of HALF cells in one row. */
static u8l relate(u8l levels, u32h gains) {
    const u32h pairs = HALF_TO_U32(REINTERPRET(levels, u16h)); /* neighbours share a word */
    const u32h left = relative_of(pairs & 255u, gains), right = relative_of(pairs >> 8u, gains);
    return REINTERPRET(HALF_TO_U16(left | right << 8u), u8l);
}

static void add_layer(bright_t *w, u32h words) {
    w->sum += words & ((1u << SV_WALL_SUM_BITS) - 1u);
    w->count += words >> (uint)SV_WALL_SUM_BITS;
}

static void take_layer(bright_t *w, u32h words) {
    w->sum -= words & ((1u << SV_WALL_SUM_BITS) - 1u);
    w->count -= words >> (uint)SV_WALL_SUM_BITS;
}

/* Relates the levels of HALF cells from column `x` on in the layers in which they were scanned, and clears
 * the others. `layers`: room for a vector a layer. */
static void relate_cells(const sv_wall_layout *l, __global const uint *info, __global const uint *windows,
                         __global const uchar *levels, uint row, uint x, extent_t scanned,
                         __global u32h *layers, __global uchar *relative) {
    const uint reach = l->window[2], begin = scanned.from - min(scanned.from, reach);
    bright_t w = {(u32h)(0), (u32h)(0)};
    for (uint z = 0; z < l->layers; z++)
        for (uint r = 0; (z < scanned.from || z >= scanned.to) && r < 2; r++)
            *(__global u8l *)(relative + level_row(l, z, 2 * row + r) + 2 * x) = (u8l)(0);
    for (uint z = begin; z < scanned.to + reach; z++) {
        if (z < l->layers) {
            layers[z] = sum_rows_near(l, windows, z, row, x);
            add_layer(&w, layers[z]);
        }
        if (z < scanned.from + reach) continue;
        const uint at = z - reach;
        if (at > begin + reach) take_layer(&w, layers[at - reach - 1]);
        const u32h gains = gains_of(l, info, &w);
        for (uint r = 0; r < 2; r++) {
            const size_t line = level_row(l, at, 2 * row + r) + 2 * x;
            *(__global u8l *)(relative + line) = relate(*(__global const u8l *)(levels + line), gains);
        }
    }
}

/* One work item per row of cells, after wall_bright: relative levels, and the number of rays that begin with
 * a few dark layers. */
__kernel void wall_relative(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                            __global const uint *restrict windows, __global const uchar *restrict levels,
                            __global ushort *restrict rays, __global uint *restrict scratch,
                            __global uchar *restrict relative, __global uint *restrict fronts) {
    const uint row = (uint)get_global_id(0);
    uint count = 0;
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint x = 0; x < vectors_of(&l); x++)
        relate_cells(&l, info, windows, levels, row, x * HALF, extent_of_vector(&l, rays, row, x),
                     (__global u32h *)(scratch + (size_t)row * scratch_words), relative);
    const uint from = extent_of_row(&l, rays, row).from;
    for (uint line = 2 * row; line < 2 * row + 2; line++)
        for (uint x = 0; x < vectors_of(&l); x++) {
            const i16l first = AS_I16(ray_row(rays, &l, RAY_FIRST, line)[x]);
            const i16l end = AS_I16(ray_row(rays, &l, RAY_END, line)[x]);
            const i16l begin =
                behind_near_field(&l, relative + level_row(&l, 0, line) + x * LANES, from, first, end);
            const i16l counted = begin > first;
            const short *lanes = (const short *)&counted;
            for (uint i = 0; i < LANES; i++) count += lanes[i] != 0;
        }
    fronts[row] = count;
}
