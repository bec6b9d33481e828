/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, while the slabs come: every voxel is read once, and added to its block; and the scanned
 * range of every pixel, where that is not the whole of it.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_SLICES_CLH
#include "wall/wall_slices.clh"
#endif

static uchar16 bytes16_of(short16 mask) {
    return as_uchar16(convert_char16(mask));
}

static short16 words16_of(uchar16 mask) {
    return convert_short16(as_char16(mask));
}

/* A row of blocks and what it is taken from. */
typedef struct {
    uint row;
    sv_wall_span span; /* its rows of pixels */
    uint padding;      /* above 255: none */
    uint pitch;        /* of the sums; zeros behind the last pixel */
    uint range_pitch;  /* of the planes of ranges */
    __global ushort *sums, *first, *end;
} strip_t;

/* Rows of pixels that are this row's to range: those between two rows of blocks belong to the second. */
static uint first_own_row(const strip_t *s) {
    return s->span.first;
}

static uint own_rows_end(const strip_t *s) {
    return s->span.first + s->span.count - s->span.shares_last;
}

/* The ranges before the first slab: all that can be said without the voxels. `scanned`: planes of the rays'
 * ranges, if `ranged`. */
static void begin_ranges(const sv_wall_layout *l, const strip_t *s, bool ranged,
                         __global const ushort *scanned) {
    for (uint y = first_own_row(s); y < own_rows_end(s); y++) {
        __global ushort *first = s->first + (size_t)y * s->range_pitch;
        __global ushort *end = s->end + (size_t)y * s->range_pitch;
        __global const ushort *from = scanned + (size_t)y * s->range_pitch;
        __global const ushort *to = from + (size_t)l->height * s->range_pitch;
        for (uint x = 0; x < l->width; x++) {
            first[x] = NEVER;
            end[x] = 0;
            if (s->padding <= 255 || (ranged && from[x] >= to[x])) continue;
            first[x] = ranged ? from[x] : (ushort)0;
            end[x] = ranged ? to[x] : (ushort)l->slices;
        }
    }
}

/* With a padding value the range of a pixel goes from its first voxel of another value to its last. */
static void note_ranges(const sv_wall_layout *l, const strip_t *s, bool ranged,
                        __global const ushort *scanned, __global const uchar *slice, uint row_pitch,
                        ushort z) {
    const uint vectors = (l->width + SV_LANES - 1) / SV_LANES;
    const short16 inside = words16_of(pixels_of((vectors - 1) * SV_LANES, l->width));
    for (uint y = first_own_row(s); y < own_rows_end(s); y++) {
        __global ushort16 *first = (__global ushort16 *)(s->first + (size_t)y * s->range_pitch);
        __global ushort16 *end = (__global ushort16 *)(s->end + (size_t)y * s->range_pitch);
        __global const ushort16 *from = (__global const ushort16 *)(scanned + (size_t)y * s->range_pitch);
        __global const ushort16 *to = from + (size_t)l->height * s->range_pitch / SV_LANES;
        for (uint x = 0; x < vectors; x++) {
            const uchar16 v = load_voxels(slice + (size_t)y * row_pitch, x * SV_LANES, l->width);
            short16 seen = words16_of(as_uchar16(v != (uchar16)((uchar)s->padding)));
            if (x + 1 == vectors) seen &= inside;
            if (ranged) seen &= (from[x] <= z) & (to[x] > z);
            first[x] = min(first[x], select((ushort16)(NEVER), (ushort16)(z), as_ushort16(seen)));
            end[x] = max(end[x], (ushort16)((ushort)(z + 1)) & as_ushort16(seen));
        }
    }
}

/* LANES voxels from `at` on. Rows that have fewer end with zeros. */
static u8l load_lanes(__global const uchar *at, bool narrow, uint width) {
    if (!narrow) return ((__global const u8l_anywhere *)at)->v;
    uchar16 parts[LANES / SV_LANES];
    for (uint i = 0; i < LANES / SV_LANES; i++) {
        const uint x = i * SV_LANES;
        parts[i] = (uchar16)(0);
        if (x < width) parts[i] = load_voxels(at, x, width) & pixels_of(x, width);
    }
    return *(const u8l *)parts;
}

/* Sums of LANES columns from x on over `count` slices; 0 where there is padding. */
static u16l sum_slices(const sv_wall_layout *l, const strip_t *s, const texture_t *t, uint i, uint count,
                       uint x) {
    const bool narrow = l->width < LANES;
    u16l sum = (u16l)(0);
    for (uint k = i; k < i + count; k++) {
        __global const uchar *at = slice_of(t, k) + (size_t)s->span.first * t->row_pitch + x;
        for (uint j = 0; j < s->span.count; j++) {
            const bool shared =
                (j == 0 && s->span.shares_first) || (j + 1 == s->span.count && s->span.shares_last);
            u8l v = load_lanes(at + (size_t)j * t->row_pitch, narrow, l->width);
            if (s->padding <= 255) v &= AS_U8(v != (u8l)((uchar)s->padding));
            sum += TO_U16(v) << (u16l)((ushort)(shared ? 0 : 1));
        }
    }
    return sum;
}

/* Adds `count` slices to the row's sums; `fresh`: the first one is the first of its layer. What is left over
 * at the end of a row is summed with the pixels before it, and then moved to its place: to move every row
 * would take longer than all the rest. */
static void add_slices(const sv_wall_layout *l, const strip_t *s, const texture_t *t, uint i, uint count,
                       bool fresh) {
    const u16l keep = (u16l)((ushort)(fresh ? 0 : 0xffff));
    __global u16l *sums = (__global u16l *)s->sums;
    for (uint x = 0; x < l->width; x += LANES) {
        const uint from = x + LANES <= l->width || l->width < LANES ? x : l->width - LANES;
        u16l sum = sum_slices(l, s, t, i, count, from);
        if (from < x) {
            u16l moved[2];
            moved[0] = sum;
            moved[1] = (u16l)(0);
            sum = ((const u16l_anywhere *)((const ushort *)moved + (x - from)))->v;
        }
        sums[x / LANES] = (sums[x / LANES] & keep) + sum;
    }
}

/* Quotients, rounded half up; exact, whatever the rounding of the float32 estimate. */
static uint16 mean_of(uint16 sum, uint16 weight) {
    const uint16 scaled = sum + weight / 2u;
    uint16 mean = convert_uint16(convert_float16(scaled) / convert_float16(weight));
    const int16 rest = as_int16(scaled - mean * weight);
    mean -= as_uint16(rest < (int16)(0)) & 1u;
    return mean + (as_uint16((rest >= as_int16(weight)) & (rest >= (int16)(0))) & 1u);
}

/* Sums of the columns of 16 blocks from `column` on, and what they weigh but for rows and slices. */
static uint16 gather(const sv_wall_layout *l, __global const sv_wall_span *spans, __global const ushort *sums,
                     uint column, uint16 *weight) {
    uint lanes[SV_LANES], weights[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) {
        lanes[i] = 0;
        weights[i] = 1;
        if (column + i >= l->columns) continue;
        __global const sv_wall_span *s = &spans[column + i];
        __global const ushort *from = sums + s->first;
        for (uint k = 0; k < s->count; k++) lanes[i] += 2u * from[k];
        if (s->shares_first) lanes[i] -= from[0];
        if (s->shares_last) lanes[i] -= from[s->count - 1];
        weights[i] = s->weight;
    }
    *weight = *(const uint16 *)weights;
    return *(const uint16 *)lanes;
}

/* The same where all blocks are `side` pixels wide, and none shares one. */
static uint16 gather_even(__global const ushort *sums, uint side) {
    uint lanes[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) {
        lanes[i] = 0;
        for (uint k = 0; k < side; k++) lanes[i] += 2u * sums[i * side + k];
    }
    return *(const uint16 *)lanes;
}

static uint16 gather_known(__global const ushort *sums, uint side) {
    if (side == 2) { /* a power of two: shuffles */
        const ushort16 a = vload16(0, sums), b = vload16(1, sums);
        const ushort16 even = (ushort16)(a.even, b.even), odd = (ushort16)(a.odd, b.odd);
        return (convert_uint16(even) + convert_uint16(odd)) * 2u;
    }
    if (side == 3) return gather_even(sums, 3); /* a number: the compiler unrolls it */
    if (side == 4) return gather_even(sums, 4);
    return gather_even(sums, side);
}

/* The means of a row's blocks, now that the layer is complete. */
static void leave_layer(const sv_wall_layout *l, const strip_t *s, __global const sv_wall_span *spans,
                        uint layer, __global uchar *levels) {
    const uint slices = min(l->depth, l->slices - layer * l->depth);
    const uint side = l->width % l->columns == 0 ? l->width / l->columns : 0;
    const uint16 by = (uint16)(s->span.weight * slices);
    for (uint x = 0; x < padded_columns_of(l); x += SV_LANES) {
        uint16 weight = (uint16)(2 * side), sum;
        if (side && (x + SV_LANES) * side <= s->pitch)
            sum = gather_known(s->sums + x * side, side);
        else
            sum = gather(l, spans, s->sums, x, &weight);
        *(__global uchar16 *)(levels + x) = convert_uchar16(mean_of(sum, weight * by));
    }
}

/* One work item per row of blocks. `ranged`: `scanned` has planes of the pixels' ranges. `spans`: of the
 * columns, then of the rows. `ranges`: two planes like those of `scanned`; without ranges and padding they
 * are left alone. */
__kernel void wall_take(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint padding,
                        uint ranged, uint range_pitch, __global const ushort *restrict scanned,
                        sv_wall_layout l, __global const sv_wall_span *restrict spans,
                        __global ushort *restrict sums, __global ushort *restrict ranges,
                        __global uchar *restrict levels) {
    const uint row = (uint)get_global_id(0), pitch = (l.width + LANES - 1) / LANES * LANES;
    const strip_t s = {.row = row,
                       .span = spans[l.columns + row],
                       .padding = padding,
                       .pitch = pitch,
                       .range_pitch = range_pitch,
                       .sums = sums + (size_t)row * pitch,
                       .first = ranges,
                       .end = ranges + (size_t)l.height * range_pitch};
    if (first_slice == 0 && (ranged || padding <= 255)) begin_ranges(&l, &s, ranged != 0, scanned);
    const texture_t t = {slab + slab_offset, row_pitch, tiles_x, tile_w, tile_h};
    if (padding <= 255)
        for (uint i = 0; i < slice_count; i++)
            note_ranges(&l, &s, ranged != 0, scanned, slice_of(&t, i), row_pitch, (ushort)(first_slice + i));
    for (uint i = 0; i < slice_count;) {
        const uint z = first_slice + i, layer = z / l.depth;
        const uint layer_end = min((layer + 1) * l.depth, l.slices);
        const uint count = min(layer_end - z, slice_count - i);
        add_slices(&l, &s, &t, i, count, z % l.depth == 0);
        i += count;
        if (z + count == layer_end) leave_layer(&l, &s, spans, layer, levels + level_row(&l, layer, row));
    }
}
