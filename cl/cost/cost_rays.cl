/* SPDX-License-Identifier: MIT */
/*
 * Cost volume, along the rays: voxels to bins while the slabs come, then the grey levels of fluid and tissue.
 */
#ifndef SV_METHOD_COST_CLH
#include "cost/cost.clh"
#endif

/* Limits of the pixels along the side of a ray, and of the slices of a bin: the volume's sides are at most
 * 8192. */
#define MAX_SHRINK     (8192 / SV_COST_RAYS)
#define MAX_BIN_SLICES ((8192 + SV_COST_LABELS - 1) / SV_COST_LABELS)

/* A slab as it lies in its texture, and what of it was not scanned: voxels of a grey level (above 255:
 * none), and those outside the rays' scanned ranges (profile/scanned.cl), if there are any. */
typedef struct {
    __global const uchar *texture;
    uint row_pitch, tiles_x, tile_w, tile_h;
    uint padding;
    bool ranged;
    __global const ushort *first, *end;
    uint padded_width; /* of their rows */
} slab_t;

/* Slices of a slab that belong to one bin. */
typedef struct {
    uint bin, count;
    bool begun, ends; /* the bin began in an earlier slab; it ends with these slices */
    uint first;       /* number of the first slice in the volume */
    __global const uchar *slice[MAX_BIN_SLICES];
} piece_t;

static __global const uchar *slice_at(const slab_t *s, uint slice) {
    return s->texture + (size_t)(slice / s->tiles_x) * s->tile_h * s->row_pitch +
           slice % s->tiles_x * s->tile_w;
}

/* Returns 255 where a voxel of slice `slice`, pixels x to x + 15 of row y, was scanned. */
static uchar16 scanned_of(const slab_t *s, uchar16 v, uint slice, uint x, uint y) {
    uchar16 scanned = s->padding > 255 ? (uchar16)(255) : as_uchar16(v != (uchar16)((uchar)s->padding));
    if (s->ranged) {
        const size_t at = (size_t)y * s->padded_width + x;
        const short16 inside = vload16(0, s->first + at) <= (ushort16)((ushort)slice) &
                               vload16(0, s->end + at) > (ushort16)((ushort)slice);
        scanned &= as_uchar16(convert_char16(inside));
    }
    return scanned;
}

/* True if bins have one or two whole slices and single pixels, as is usual: they need no sums. */
static bool bins_are_small(const slab_t *s, const sv_cost_layout *l, uint first_slice, uint slice_count) {
    const bool whole = first_slice % l->bin_slices == 0 &&
                       (slice_count % l->bin_slices == 0 || first_slice + slice_count == l->slices);
    return l->shrink == 1 && l->bin_slices <= 2 && whole;
}

/* Averages one or two slices of a row of rays into a small bin, rounded half up, at least 1. */
static void copy_row(const slab_t *s, const sv_cost_layout *l, uint first_slice, uint i, uint count, uint y,
                     __global uchar16 *to) {
    const uint vectors = l->padded_columns / SV_LANES, slice = first_slice + i;
    const size_t at = (size_t)y * s->row_pitch;
    __global const uchar *one = slice_at(s, i) + at, *two = slice_at(s, i + count - 1) + at;
    for (uint v = 0; v < vectors; v++) {
        const uint x = v * SV_LANES;
        const uchar16 a = load_voxels(one, x, l->width), in_a = scanned_of(s, a, slice, x, y);
        if (count == 1) {
            to[v] = max(a, (uchar16)(1)) & in_a;
            continue;
        }
        const uchar16 b = load_voxels(two, x, l->width), in_b = scanned_of(s, b, slice + 1, x, y);
        const uchar16 both = in_a & in_b, either = in_a | in_b;
        const uchar16 mean = (rhadd(a, b) & both) | (((a & in_a) | (b & in_b)) & ~both);
        to[v] = max(mean, (uchar16)(1)) & either;
    }
    to[vectors - 1] &= pixels_of(l->padded_columns - SV_LANES, l->width);
}

/* Returns the mean rounded half up, at least 1; 0 of none. It is exact, whatever the rounding of a device's
 * division. */
static uchar16 rounded_mean(uint16 sum, uint16 count) {
    const int16 divisor = convert_int16(max(count, (uint16)(1))), whole = convert_int16(sum + count / 2u);
    int16 mean = convert_int16(convert_float16(whole) / convert_float16(divisor));
    mean += mean * divisor > whole;
    mean -= (mean + 1) * divisor <= whole;
    return convert_uchar16(max(mean, (int16)(1)) & (count != (uint16)(0)));
}

/* Adds up and counts the scanned voxels of 16 pixels from x on, a multiple of 16, over the pixel rows of a
 * row of rays. If the bin goes on in the next slab the sums wait in `partial`, a pixel row each. */
static void add_piece(const slab_t *s, const sv_cost_layout *l, const piece_t *piece, uint x, uint row,
                      __global ushort16 *partial, uint16 *sum, uint16 *count) {
    const uint pitch = (l->width + SV_LANES - 1) / SV_LANES, y1 = min((row + 1) * l->shrink, l->height);
    const uchar16 inside = pixels_of(x, l->width);
    *sum = *count = (uint16)(0);
    for (uint y = row * l->shrink; y < y1; y++) {
        __global ushort16 *waiting = partial + (size_t)y * pitch + x / SV_LANES;
        __global ushort16 *waiting_count = waiting + (size_t)pitch * l->height;
        const size_t at = (size_t)y * s->row_pitch;
        ushort16 some = (ushort16)(0);
        uchar16 number = (uchar16)(0); /* SV_COST_LABELS bins of 8192 slices have 43 */
        if (piece->begun) {
            some = *waiting;
            number = convert_uchar16(*waiting_count);
        }
        for (uint i = 0; i < piece->count; i++) {
            const uchar16 v = load_voxels(piece->slice[i] + at, x, l->width);
            const uchar16 scanned = scanned_of(s, v, piece->first + i, x, y) & inside;
            some += convert_ushort16(v & scanned);
            number -= scanned;
        }
        if (piece->ends) {
            *sum += convert_uint16(some);
            *count += convert_uint16(number);
        } else {
            *waiting = some;
            *waiting_count = convert_ushort16(number);
        }
    }
}

/* Sums up `shrink` neighbours of as many vectors, for 16 rays. */
static uint16 shrunk(uint16 *values, uint shrink) {
    for (; shrink % 2 == 0; shrink /= 2)
        for (uint k = 0; k < shrink / 2; k++) {
            const uint16 a = values[2 * k], b = values[2 * k + 1];
            values[k] = (uint16)(a.even + a.odd, b.even + b.odd);
        }
    if (shrink == 1) return values[0];
    const uint *pixels = (const uint *)values;
    uint16 sums;
    for (uint i = 0; i < SV_LANES; i++, pixels += shrink) {
        uint sum = 0;
        for (uint k = 0; k < shrink; k++) sum += pixels[k];
        ((uint *)&sums)[i] = sum;
    }
    return sums;
}

/* Adds the slices of one bin for a row of rays. */
static void add_row(const slab_t *s, const sv_cost_layout *l, const piece_t *piece, uint row,
                    __global ushort16 *partial, __global uchar16 *bins) {
    uint16 sums[MAX_SHRINK], counts[MAX_SHRINK]; /* of the pixels of 16 rays */
    const uint vectors = l->padded_columns / SV_LANES;
    bins += bins_at(l, row, piece->bin) / SV_LANES;
    for (uint rays = 0; rays < vectors; rays++) {
        for (uint k = 0; k < l->shrink; k++) {
            const uint x = (rays * l->shrink + k) * SV_LANES;
            sums[k] = counts[k] = (uint16)(0);
            if (x < l->width) add_piece(s, l, piece, x, row, partial, sums + k, counts + k);
        }
        if (piece->ends) bins[rays] = rounded_mean(shrunk(sums, l->shrink), shrunk(counts, l->shrink));
    }
}

/* One work item per row of rays. `padding` above 255: no grey level means "not scanned". `ranged`: `scanned`
 * has the ranges. `partial`: sums, then numbers of scanned voxels, of the pixels of the bin that a slab left
 * unfinished; not used if bins are voxels. */
__kernel void cost_bins(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint padding,
                        uint ranged, uint padded_width, __global const ushort *restrict scanned,
                        sv_cost_layout l, __global ushort16 *restrict partial,
                        __global uchar16 *restrict bins) {
    const uint row = (uint)get_global_id(0);
    const size_t plane = (size_t)padded_width * l.height;
    const slab_t s = {.texture = slab + slab_offset,
                      .row_pitch = row_pitch,
                      .tiles_x = tiles_x,
                      .tile_w = tile_w,
                      .tile_h = tile_h,
                      .padding = padding,
                      .ranged = ranged != 0,
                      .first = scanned + SV_SCANNED_FIRST * plane,
                      .end = scanned + SV_SCANNED_END * plane,
                      .padded_width = padded_width};
    if (bins_are_small(&s, &l, first_slice, slice_count)) {
        for (uint i = 0; i < slice_count; i += l.bin_slices)
            copy_row(&s, &l, first_slice, i, min(l.bin_slices, slice_count - i), row,
                     bins + bins_at(&l, row, (first_slice + i) / l.bin_slices) / SV_LANES);
        return;
    }
    piece_t piece;
    for (uint first = 0; first < slice_count; first += piece.count) {
        const uint slice = first_slice + first;
        piece.bin = slice / l.bin_slices;
        const uint end = min((piece.bin + 1) * l.bin_slices, l.slices);
        piece.count = min(end - slice, slice_count - first);
        piece.begun = slice > piece.bin * l.bin_slices;
        piece.ends = slice + piece.count == end;
        piece.first = slice;
        for (uint i = 0; i < piece.count; i++) piece.slice[i] = slice_at(&s, first + i);
        add_row(&s, &l, &piece, row, partial, bins);
    }
}

/* One work item per row of cells: the histogram of the bins on its middle row. Four counters take turns, as
 * neighbours are often alike, and a counter must be written before it is read again. */
__kernel void cost_histogram(sv_cost_layout l, __global const uchar *restrict bins,
                             __global uint *restrict histograms) {
    const uint cell_row = (uint)get_global_id(0);
    __global const uchar4 *row = (__global const uchar4 *)(bins + bins_at(&l, middle_row(&l, cell_row), 0));
    const uint count = l.labels * l.padded_columns / 4;
    uint counts[4][256];
    for (uint i = 0; i < 256; i += 4)
        for (uint k = 0; k < 4; k++) vstore4((uint4)(0), 0, counts[k] + i);
    for (uint i = 0; i < count; i++) {
        const uchar4 v = row[i];
        if (as_uint(v) == 0) continue; /* not scanned, which is not counted */
        counts[0][v.x]++;
        counts[1][v.y]++;
        counts[2][v.z]++;
        counts[3][v.w]++;
    }
    for (uint i = 0; i < 256; i++)
        histograms[cell_row * 256 + i] = counts[0][i] + counts[1][i] + counts[2][i] + counts[3][i];
}

/* One work item: finds T_L by isodata thresholding (the threshold lies midway between the means of the dark
 * and the bright class, and is moved until it stays). T_L is a sixth of the way from the dark mean to the
 * bright one, which is stored, too. */
__kernel void cost_level(sv_cost_layout l, __global const uint *restrict histograms,
                         __global uint *restrict info) {
    uint counts[256];
    ulong all = 0, total = 0;
    for (uint i = 0; i < 256; i++) counts[i] = 0;
    for (uint row = 0; row < l.cells_y; row++)
        for (uint i = 0; i < 256; i++) counts[i] += histograms[row * 256 + i];
    for (uint i = 1; i < 256; i++) {
        all += counts[i];
        total += (ulong)i * counts[i];
    }
    ulong threshold = all > 0 ? total / all : 0, dark = 0, bright = 0;
    for (uint turn = 0; turn < 32; turn++) {
        ulong count = 0, sum = 0;
        for (uint i = 1; i <= threshold; i++) {
            count += counts[i];
            sum += (ulong)i * counts[i];
        }
        dark = count > 0 ? sum / count : 0;
        bright = all > count ? (total - sum) / (all - count) : threshold;
        const ulong next = (dark + bright) / 2;
        if (next == threshold) break;
        threshold = next;
    }
    const bool fluid = bright >= 2 * dark; /* else there is none */
    info[SV_COST_INFO_LEVEL] = fluid ? max((uint)(dark + (bright - dark) / 6), 1u) : 0;
    info[SV_COST_INFO_BRIGHT] = max((uint)bright, 1u);
}
