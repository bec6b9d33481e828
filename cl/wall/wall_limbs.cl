/* SPDX-License-Identifier: MIT */
/*
 * In both layouts: limbs that float, along the beams (sv_wall_limbs_of), and the cells of a camera that lie
 * there. The samples of a plane of beams in one layer are a word, and a line is a bit of it: a grid has
 * SV_WALL_LINES of them at most. `flag_place`, of either layout, says which byte a cell's flags are.
 */
#ifndef SV_WALL_BEAMS_CLH
#include "wall/wall_beams.clh"
#endif
#ifdef SV_WALL_ITEMS_CLH
static size_t flag_place(const sv_wall_layout *l, uint z, uint row, uint x) {
    return cell_row(l, z, row) + x;
}
#else
#ifndef SV_WALL_SURROUNDINGS_CLH
#include "wall/wall_surroundings.clh"
#endif
static size_t flag_place(const sv_wall_layout *l, uint z, uint row, uint x) {
    return (word_column(l, row, x / CELLS_OF_WORD) + z) * CELLS_OF_WORD + x % CELLS_OF_WORD;
}
#endif

/* A limb is at most so many times `full_distance` thick along its beam. */
#define LIMBS_THICK 2

/* Offset of the first layer of a plane of beams. */
static size_t limb_column(const sv_wall_layout *l, uint plane, uint row) {
    return ((size_t)plane * l->rows + row) * l->layers;
}

/* The bits of a plane of beams in one layer. */
typedef struct {
    ulong scanned, tissue, dark, skipped;
} bits_t;

/* Returns a bit for each of 16 lanes of a mask. The product moves the lowest bits of eight bytes next to each
 * other. */
static ulong bits_of_lanes(char16 mask) {
    const ulong2 bits = (as_ulong2(mask) & 0x0101010101010101UL) * 0x0102040810204080UL >> 56UL;
    return bits.s0 | bits.s1 << 8;
}

static bits_t bits_of(const sv_wall_layout *l, __global const uchar *grey, __global const uchar *relative,
                      __global const ushort *rays, uint z, uint row) {
    __global const uchar *const levels = relative + level_row(l, z, row);
    __global const uchar *const own = grey + level_row(l, z, row);
    __global const ushort *const first = rays + block_row(l, RAY_FIRST, row);
    __global const ushort *const end = rays + block_row(l, RAY_END, row);
    const ulong lines = ~0UL >> (SV_WALL_LINES - l->columns);
    bits_t b = {0, 0, 0, 0};
    for (uint x = 0; x < l->columns; x += 16) {
        const uchar16 level = vload16(0, levels + x);
        const short16 behind = as_short16(vload16(0, first + x)) <= (short16)((short)z);
        const short16 before = as_short16(vload16(0, end + x)) > (short16)((short)z);
        b.scanned |= bits_of_lanes(convert_char16(behind & before)) << x;
        b.tissue |= bits_of_lanes(level > (uchar16)(SV_WALL_TISSUE)) << x;
        b.dark |= bits_of_lanes(level <= (uchar16)((uchar)l->dim)) << x;
        b.skipped |= bits_of_lanes(~convert_char16(behind) & (vload16(0, own + x) > (uchar16)(0))) << x;
    }
    b.scanned &= lines;
    b.tissue &= b.scanned;
    b.dark &= b.scanned;
    b.skipped &= lines;
    return b;
}

/* Returns the layer from which on nothing of a plane of beams was scanned. */
static uint end_of_row(const sv_wall_layout *l, __global const ushort *rays, uint row) {
    __global const ushort *const end = rays + block_row(l, RAY_END, row);
    uint last = 0;
    for (uint x = 0; x < l->columns; x++) last = max(last, (uint)end[x]);
    return last;
}

/* Drops runs that are longer than `most`: where `most` more follow, a run is, and so is its rest. */
static void drop_thick(__global ulong *between, uint layers, uint most) {
    ulong thick = 0;
    for (uint z = 0; z < layers; z++) {
        ulong follow = z + most < layers ? between[z] : 0;
        for (uint i = 1; i <= most && follow; i++) follow &= between[z + i];
        thick = between[z] & (thick | follow);
        between[z] &= ~thick;
    }
}

/* One work item per plane of beams: the words of its layers. */
__kernel void wall_between(sv_wall_layout l, __global const uint *restrict info,
                           __global const uchar *restrict grey, __global const uchar *restrict relative,
                           __global const ushort *restrict rays, __global ulong *restrict limbs) {
    const uint row = (uint)get_global_id(0);
    /* A mask: LLVM 21, of PoCL 7.1, compiles a loop for each case, and one of them does not end. */
    const ulong wanted = info[SV_WALL_INFO_OUTCOME] != SV_WALL_EMPTY ? ~0UL : 0;
    __global ulong *const tissue = limbs + limb_column(&l, SV_WALL_LIMBS_TISSUE, row);
    __global ulong *const source = limbs + limb_column(&l, SV_WALL_LIMBS_SOURCE, row);
    __global ulong *const between = limbs + limb_column(&l, SV_WALL_LIMBS_FLOAT, row);
    __global ulong *const near = limbs + limb_column(&l, SV_WALL_LIMBS_NEAR, row);
    const uint scanned_to = end_of_row(&l, rays, row);
    ulong wall = ~0UL, behind = 0;
    for (uint z = 0; z < l.layers; z++) {
        bits_t b = {0, 0, 0, 0};
        if (z < scanned_to) b = bits_of(&l, grey, relative, rays, z, row);
        wall &= ~b.dark;
        tissue[z] = b.tissue & wanted;
        near[z] = b.skipped & wanted;
        source[z] = (b.tissue & wall) | ~(b.scanned & wanted);
    }
    for (uint z = l.layers; z-- > 0;) {
        behind |= ~(tissue[z] | source[z]);
        between[z] = tissue[z] & ~source[z] & behind;
    }
    drop_thick(between, l.layers, LIMBS_THICK * l.full_distance);
}

/* What `from` reaches through tissue upwards, and downwards. */
static ulong reached_up(ulong from, ulong tissue) {
    for (uint step = 1; step < SV_WALL_LINES; step *= 2) {
        from |= tissue & (from << step);
        tissue &= tissue << step;
    }
    return from;
}

static ulong reached_down(ulong from, ulong tissue) {
    for (uint step = 1; step < SV_WALL_LINES; step *= 2) {
        from |= tissue & (from >> step);
        tissue &= tissue >> step;
    }
    return from;
}

/* One work item per layer: what floats is reached from one side at most. Nothing was scanned outside the
 * grid. */
__kernel void wall_floating(sv_wall_layout l, __global ulong *restrict limbs) {
    const uint z = (uint)get_global_id(0);
    const size_t pitch = limb_column(&l, 0, 1);
    __global const ulong *tissue = limbs + limb_column(&l, SV_WALL_LIMBS_TISSUE, 0) + z;
    __global const ulong *source = limbs + limb_column(&l, SV_WALL_LIMBS_SOURCE, 0) + z;
    __global ulong *floats = limbs + limb_column(&l, SV_WALL_LIMBS_FLOAT, 0) + z;
    __global ulong *above = limbs + limb_column(&l, SV_WALL_LIMBS_ABOVE, 0) + z;
    ulong reached = ~0UL;
    for (size_t at = 0; at < l.rows * pitch; at += pitch)
        above[at] = reached = source[at] | (tissue[at] & reached);
    reached = ~0UL;
    for (size_t at = l.rows * pitch; at > 0;) {
        at -= pitch;
        const ulong through = tissue[at], last = 1UL << (SV_WALL_LINES - 1);
        const ulong left = reached_up(source[at] | (through & 1UL), through);
        const ulong right = reached_down(source[at] | (through & last), through);
        reached = source[at] | (through & reached);
        floats[at] &= ~((left & right) | (above[at] & reached) | ((left | right) & (above[at] | reached)));
    }
}

/* The blocks from .. to - 1 of `count` that lie near a position along an axis. */
static uint2 blocks_near(int at, int near, uint count) {
    const int one = 1 << SV_WALL_POSITION_BITS;
    const int from = (at - near + one - 1) >> SV_WALL_POSITION_BITS,
              to = ((at + near) >> SV_WALL_POSITION_BITS) + 1;
    return (uint2)((uint)max(from, 0), (uint)clamp(to, 0, (int)count));
}

/* Gives the cells near sample k of a beam CELL_FLOATS. */
static void mark_sample(const sv_wall_layout *l, const sv_wall_grid *g, const beam_t *b, uint k,
                        __global uint *flags) {
    const uint2 x = blocks_near(b->from[0] + (int)k * b->step[0], g->near[0], l->columns);
    const uint2 y = blocks_near(b->from[1] + (int)k * b->step[1], g->near[1], l->rows);
    const uint2 z = blocks_near(b->from[2] + (int)k * b->step[2], g->near[2], l->layers);
    if (x.x >= x.y || y.x >= y.y) return;
    for (uint layer = z.x; layer < z.y; layer++)
        for (uint row = y.x / 2; row <= (y.y - 1) / 2; row++)
            for (uint column = x.x / 2; column <= (x.y - 1) / 2; column++) {
                const size_t place = flag_place(l, layer, row, column);
                atomic_or(flags + place / 4, (uint)CELL_FLOATS << 8 * (place % 4));
            }
}

/* One work item per beam, for a camera, `l`: marks the cells where its samples are set in `plane_of_words`.
 */
__kernel void wall_mark_cells(sv_wall_layout l, sv_wall_grid g, uint plane_of_words,
                              __global const uint *restrict tables, __global const ulong *restrict limbs,
                              __global uint *restrict flags) {
    const uint line = (uint)get_global_id(0), plane = (uint)get_global_id(1);
    __local ulong any; /* a group has lines of one plane */
    limbs += ((size_t)plane_of_words * g.planes + plane) * g.samples;
    if (get_local_id(0) == 0) {
        ulong all = 0;
        for (uint k = 0; k < g.samples; k++) all |= limbs[k];
        any = all;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (line >= g.lines || !(any >> line & 1)) return;
    const beam_t b = beam_of(&g, tables, line, plane);
    for (uint k = b.first; k < g.samples; k++)
        if (limbs[k] >> line & 1) mark_sample(&l, &g, &b, k, flags);
}

/* One work item per ray of a camera: one that begins with dark blocks in marked cells begins behind them. */
__kernel void wall_skip_near(sv_wall_layout l, __global const uint *restrict info,
                             __global const uchar *restrict relative, __global const uchar *restrict flags,
                             __global ushort *restrict rays) {
    const uint x = (uint)get_global_id(0), row = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    __global ushort *const first = rays + block_row(&l, RAY_FIRST, row) + x;
    const uint end = rays[block_row(&l, RAY_END, row) + x];
    uint z = *first;
    while (z < end && relative[level_row(&l, z, row) + x] <= l.dim &&
           flags[flag_place(&l, z, row / 2, x / 2)])
        z++;
    if (z < end) *first = (ushort)z;
}
