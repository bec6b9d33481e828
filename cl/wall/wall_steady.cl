/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, blocks of one voxel: such a block is all speckle, so its two neighbours along every
 * axis where blocks are single weigh 1 / SV_WALL_STEADY each. Tissue is told from what comes of that.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_HISTOGRAM_CLH
#include "wall/wall_histogram.clh"
#endif

/* Scanned layers of LANES rays. */
typedef struct {
    i16l first, end;
} scan_t;

/* Of the rays of row `row` from column `x` on; beyond the border nothing was scanned. */
static scan_t scan_of(const sv_wall_layout *l, __global ushort *rays, int x, int row) {
    scan_t s = {.first = (i16l)(0), .end = (i16l)(0)};
    if (row < 0 || row >= (int)l->rows) return s;
    __global const short *first = (__global const short *)ray_row(rays, l, RAY_FIRST, (uint)row);
    __global const short *end = (__global const short *)ray_row(rays, l, RAY_END, (uint)row);
    for (int i = 0; i < LANES; i++) {
        if (x + i < 0 || x + i >= (int)l->columns) continue;
        ((short *)&s.first)[i] = first[x + i];
        ((short *)&s.end)[i] = end[x + i];
    }
    return s;
}

static i16l is_scanned(const scan_t *s, int z) {
    const i16l at = (i16l)((short)z);
    return (s->first <= at) & (s->end > at);
}

/* LANES levels of layer `z`; `own` where that was not scanned. */
static u16l level_beside(__global const uchar *level, const scan_t *s, int z, u16l own) {
    const u16l other = TO_U16(((__global const u8l_anywhere *)level)->v);
    return PICK(own, other, AS_U16(is_scanned(s, z)));
}

/* LANES rays from column `x` on, front to back. */
static void steady_rays(const sv_wall_layout *l, __global const uchar *levels, __global ushort *rays, uint x,
                        uint row, __global uchar *to, uint histogram[4][256]) {
    const size_t start = level_row(l, 0, row) + x, pitch = level_row(l, 1, row) - level_row(l, 0, row);
    const size_t next_row = level_row(l, 0, row + 1) - level_row(l, 0, row);
    const uint axes = l->single[0] + l->single[1] + l->single[2];
    const int column = (int)x, line = (int)row;
    const scan_t own = scan_of(l, rays, column, line), left = scan_of(l, rays, column - 1, line),
                 right = scan_of(l, rays, column + 1, line), above = scan_of(l, rays, column, line - 1),
                 below = scan_of(l, rays, column, line + 1);
    for (int z = 0; z < (int)l->layers; z++) {
        __global const uchar *at = levels + start + (size_t)z * pitch;
        const u16l level = TO_U16(*(__global const u8l *)at);
        u16l sum = level * (u16l)((ushort)(SV_WALL_STEADY - 2 * axes));
        if (l->single[0])
            sum += level_beside(at - 1, &left, z, level) + level_beside(at + 1, &right, z, level);
        if (l->single[1]) {
            sum += row > 0 ? level_beside(at - next_row, &above, z, level) : level;
            sum += row + 1 < l->rows ? level_beside(at + next_row, &below, z, level) : level;
        }
        if (l->single[2]) {
            sum += z > 0 ? level_beside(at - pitch, &own, z - 1, level) : level;
            sum += level_beside(at + pitch, &own, z + 1, level); /* zeros lie behind the last layer */
        }
        const i16l scanned = is_scanned(&own, z);
        const u16l mean = (sum + (u16l)(SV_WALL_STEADY / 2)) / (u16l)(SV_WALL_STEADY);
        const u8l steady = TO_U8(mean) & bytes_of(scanned);
        *(__global u8l *)(to + start + (size_t)z * pitch) = steady;
        count(histogram, steady, scanned);
    }
}

/* One work item per row of rays, after wall_blocks: `steady` lies as `levels` do. Only where there are blocks
 * of one voxel. */
__kernel void wall_steady(sv_wall_layout l, __global const uchar *restrict levels,
                          __global ushort *restrict rays, __global uchar *restrict steady,
                          __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0);
    uint histogram[4][256];
    clear_counts(histogram);
    for (uint x = 0; x < padded_columns_of(&l); x += LANES)
        steady_rays(&l, levels, rays, x, row, steady, histogram);
    leave_counts(histogram, histograms + (size_t)row * HISTOGRAM_WORDS);
}
