/*
 * Cost volume, along the rays: voxels to bins while the slabs come, then the grey levels of fluid and tissue.
 *
 * Bins lie as label, row, column (rows padded to 16 by zeros), so that a vector is one label of 16
 * neighbouring rays.
 */
#ifndef SV_METHOD_COST_CLH
#include "method_cost.clh"
#endif

/* Pixels along the side of a ray at most: 8192 / SV_COST_RAYS. */
#define MOST_SHRINK 64

/* A slab as it lies in its texture, and the grey level that was not scanned (above 255: none). */
typedef struct {
    __global const uchar *texture;
    uint row_pitch, tiles_x, tile_w, tile_h;
    uint padding;
} slab_t;

/* Slices of a slab that belong to one bin. */
typedef struct {
    uint bin, first, count; /* first: of the slab */
    bool begun, ends;       /* the bin began in a slab before; it ends with these slices */
} piece_t;

static __global const uchar *voxel_row(const slab_t *s, uint slice, uint y) {
    return s->texture + ((size_t)(slice / s->tiles_x) * s->tile_h + y) * s->row_pitch +
           slice % s->tiles_x * s->tile_w;
}

/* First of the 16 pixels that the vector at x, a multiple of 16, stands for: the last one of a row ends with
 * it and overlaps the one before. */
static uint vector_start(uint x, uint width) {
    return width < SV_LANES ? 0 : min(x, width - SV_LANES);
}

/* 16 voxels from x on; zeros beyond a row that is shorter. */
static uchar16 load_voxels(__global const uchar *row, uint x, uint width) {
    if (width >= SV_LANES) return vload16(0, row + x);
    uchar lanes[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) lanes[i] = i < width ? row[i] : 0;
    return vload16(0, lanes);
}

/* A row of rays whose bins are single voxels. */
static void copy_row(const slab_t *s, const cost_layout *l, uint first_slice, uint slice_count, uint y,
                     __global uchar *bins) {
    const uchar16 padding = (uchar16)((uchar)s->padding);
    const uchar16 padded = (uchar16)((uchar)(s->padding > 255 ? 0 : 255));
    const uchar16 inside =
        convert_uchar16(LANE_NUMBERS) < (uchar16)((uchar)min(l->width, 16u)) ? (uchar16)(255) : (uchar16)(0);
    for (uint i = 0; i < slice_count; i++) {
        __global const uchar *row = voxel_row(s, i, y);
        __global uchar *to = bins + ((size_t)(first_slice + i) * l->rows + y) * l->padded_columns;
        vstore16((uchar16)(0), 0, to + l->padded_columns - SV_LANES);
        for (uint x = 0; x < l->width; x += SV_LANES) {
            const uint start = vector_start(x, l->width);
            const uchar16 v = load_voxels(row, start, l->width);
            const uchar16 unscanned = as_uchar16(v == padding) & padded;
            vstore16(max(v, (uchar16)(1)) & ~unscanned & inside, 0, to + start);
        }
    }
}

/* The mean rounded half up, at least 1; 0 of none. Exact, whatever the rounding of a device's division. */
static uchar16 rounded_mean(uint16 sum, uint16 count) {
    const int16 least = convert_int16(max(count, (uint16)(1))), whole = convert_int16(sum + count / 2u);
    int16 mean = convert_int16(convert_float16(whole) / convert_float16(least));
    mean += mean * least > whole;
    mean -= (mean + 1) * least <= whole;
    return convert_uchar16(max(mean, (int16)(1)) & (count != (uint16)(0)));
}

/* Sums and numbers of the scanned voxels of 16 pixels (x: of the vector, a multiple of 16), for the pixel
 * rows of a row of rays. If the bin goes on in the next slab they wait in `partial`, a pixel row each. */
static void add_piece(const slab_t *s, const cost_layout *l, const piece_t *piece, uint x, uint row,
                      __global ushort *partial, uint16 *sum, uint16 *count) {
    const uint pitch = (l->width + SV_LANES - 1) / SV_LANES * SV_LANES;
    const uint start = vector_start(x, l->width), y1 = min((row + 1) * l->shrink, l->height);
    const uchar16 padding = (uchar16)((uchar)s->padding);
    const uchar16 padded = (uchar16)((uchar)(s->padding > 255 ? 0 : 255));
    *sum = *count = (uint16)(0);
    for (uint y = row * l->shrink; y < y1; y++) {
        __global ushort *waiting = partial + (size_t)y * pitch + x;
        __global ushort *waiting_count = waiting + (size_t)pitch * l->height;
        ushort16 some = (ushort16)(0), number = some;
        if (piece->begun) {
            some = vload16(0, waiting);
            number = vload16(0, waiting_count);
        }
        for (uint i = 0; i < piece->count; i++) {
            const uchar16 v = load_voxels(voxel_row(s, piece->first + i, y), start, l->width);
            const uchar16 scanned = ~(as_uchar16(v == padding) & padded);
            some += convert_ushort16(v & scanned);
            number += convert_ushort16(scanned & (uchar16)(1));
        }
        if (piece->ends) {
            *sum += convert_uint16(some);
            *count += convert_uint16(number);
        } else {
            vstore16(some, 0, waiting);
            vstore16(number, 0, waiting_count);
        }
    }
}

/* Sums of `shrink` neighbours, for 16 rays; `pixels`: how many of them there are. */
static uint16 shrunk(const uint *values, uint shrink, uint pixels) {
    if (shrink == 1)
        return convert_int16(LANE_NUMBERS) < (int16)((int)pixels) ? vload16(0, values) : (uint16)(0);
    uint lanes[SV_LANES];
    for (uint i = 0; i < SV_LANES; i++) {
        const uint end = min((i + 1) * shrink, pixels);
        uint sum = 0;
        for (uint k = i * shrink; k < end; k++) sum += values[k];
        lanes[i] = sum;
    }
    return vload16(0, lanes);
}

/* A row of rays: the slices of one bin. */
static void add_row(const slab_t *s, const cost_layout *l, const piece_t *piece, uint row,
                    __global ushort *partial, __global uchar *bins) {
    /* Pixels of 16 rays, behind room for those that the last vector of a row overlaps. */
    uint sums[SV_LANES * (MOST_SHRINK + 1)], counts[SV_LANES * (MOST_SHRINK + 1)];
    const uint span = SV_LANES * l->shrink;
    __global uchar *to = bins + ((size_t)piece->bin * l->rows + row) * l->padded_columns;
    for (uint x0 = 0; x0 < l->width; x0 += span) {
        const uint pixels = min(span, l->width - x0);
        for (uint x = x0; x < x0 + pixels; x += SV_LANES) {
            uint16 sum, count;
            add_piece(s, l, piece, x, row, partial, &sum, &count);
            const uint at = SV_LANES + vector_start(x, l->width) - x0;
            vstore16(sum, 0, sums + at);
            vstore16(count, 0, counts + at);
        }
        if (piece->ends)
            vstore16(rounded_mean(shrunk(sums + SV_LANES, l->shrink, pixels),
                                  shrunk(counts + SV_LANES, l->shrink, pixels)),
                     0, to + x0 / l->shrink);
    }
}

/* One work item per row of rays. `padding` above 255: every voxel was scanned. `partial`: sums, then numbers
 * of scanned voxels, of the pixels of the bin that a slab left unfinished; unused where bins are voxels. */
__kernel void cost_bins(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint padding,
                        cost_layout l, __global ushort *restrict partial, __global uchar *restrict bins) {
    const uint row = (uint)get_global_id(0);
    const slab_t s = {slab + slab_offset, row_pitch, tiles_x, tile_w, tile_h, padding};
    if (l.shrink == 1 && l.per == 1) {
        copy_row(&s, &l, first_slice, slice_count, row, bins);
        return;
    }
    piece_t piece;
    for (piece.first = 0; piece.first < slice_count; piece.first += piece.count) {
        const uint slice = first_slice + piece.first;
        piece.bin = slice / l.per;
        const uint end = min((piece.bin + 1) * l.per, l.slices);
        piece.count = min(end - slice, slice_count - piece.first);
        piece.begun = slice > piece.bin * l.per;
        piece.ends = slice + piece.count == end;
        add_row(&s, &l, &piece, row, partial, bins);
    }
}

/* One work item per row of cells: the histogram of the bins on its middle row. Four counters take turns, as
 * neighbours are often alike, and a counter must be written before it is read again. */
__kernel void cost_survey(cost_layout l, __global const uchar *restrict bins,
                          __global uint *restrict histograms) {
    const uint cell_row = (uint)get_global_id(0);
    __global const uchar *row = bins + (size_t)middle_row(&l, cell_row) * l.padded_columns;
    uint counts[4][256];
    for (uint i = 0; i < 256; i += 4)
        for (uint k = 0; k < 4; k++) vstore4((uint4)(0), 0, counts[k] + i);
    for (uint bin = 0; bin < l.labels; bin++, row += (size_t)l.rows * l.padded_columns)
        for (uint x = 0; x < l.padded_columns; x += 4) {
            const uchar4 v = vload4(0, row + x);
            counts[0][v.x]++;
            counts[1][v.y]++;
            counts[2][v.z]++;
            counts[3][v.w]++;
        }
    counts[0][0] -= (l.padded_columns - l.columns) * l.labels;
    for (uint i = 0; i < 256; i++)
        histograms[cell_row * 256 + i] = counts[0][i] + counts[1][i] + counts[2][i] + counts[3][i];
}

/* One work item: the level of fluid, a sixth of the way from the mean of the dark class to that of the bright
 * one, and the latter. */
__kernel void cost_level(cost_layout l, __global const uint *restrict histograms,
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
    ulong split = all > 0 ? total / all : 0, dark = 0, bright = 0;
    for (uint turn = 0; turn < 32; turn++) {
        ulong count = 0, sum = 0;
        for (uint i = 1; i <= split; i++) {
            count += counts[i];
            sum += (ulong)i * counts[i];
        }
        dark = count > 0 ? sum / count : 0;
        bright = all > count ? (total - sum) / (all - count) : split;
        const ulong next = (dark + bright) / 2;
        if (next == split) break;
        split = next;
    }
    const bool fluid = bright >= 2 * dark; /* else there is none */
    info[SV_COST_INFO_LEVEL] = fluid ? max((uint)(dark + (bright - dark) / 6), 1u) : 0;
    info[SV_COST_INFO_BRIGHT] = max((uint)bright, 1u);
}
