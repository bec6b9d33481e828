/* SPDX-License-Identifier: MIT */
/*
 * While the slabs come: adds every voxel to the blocks that it lies in, and finds the scanned range of every
 * pixel, where that is not the whole ray.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_MEANS_CLH
#include "wall/wall_means.clh"
#endif
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
#endif

#define MAX_WIDTH 8192 /* pixels across, as the ABI has it */

/* So many rows of pixels are summed up at a time where blocks have more than twice as many. */
#define FETCHED_ROWS 4

static uchar16 bytes16_of(short16 mask) {
    return as_uchar16(convert_char16(mask));
}

/* A row of cells, its two rows of rays, and the pixels that they are made of. */
typedef struct {
    uint row;
    uint first_row, rows; /* of pixels that lie in their blocks */
    /* of each of them for the two rows of rays, twice in a word: such words are quicker to repeat */
    uint weight[2][2 * SV_WALL_SPAN];
    /* Sums of pixels of each row of rays, with MEANS_MARGIN words in front of and behind them. Two layers
     * alternate, for a vector that was just stored is slow to load in parts. */
    __global ushort *sums[2][2];
    weights_t weights;
    uint taps;    /* pixels across a block at most; at least TAPS */
    uint at_once; /* so many rows of pixels are summed up at a time, while those below them are fetched */
    uint padding; /* above 255: none */
    bool ranged;  /* pixels have ranges, and those of LANES pixels are: */
    extent_t scanned[MAX_WIDTH / LANES];
    extent_t any;     /* of all of them */
    uint range_pitch; /* of the planes of ranges */
    __global ushort *first, *end;
} strip_t;

/* Rows of pixels before those whose ranges row `row` finds: every pixel belongs to one row of cells. */
static uint rows_before(const sv_wall_layout *l, uint row) {
    return row * l->height / l->cells[1];
}

/* Sets the ranges before the first slab, as far as they are known without the voxels. `scanned`: planes of
 * the rays' ranges, if `ranged`. */
static void begin_ranges(const sv_wall_layout *l, const strip_t *s, bool ranged,
                         __global const ushort *scanned) {
    for (uint y = rows_before(l, s->row); y < rows_before(l, s->row + 1); y++) {
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

/* Widens the ranges by a slice: with a padding value the range of a pixel goes from its first voxel of
 * another value to its last. */
static void note_ranges(const sv_wall_layout *l, const strip_t *s, bool ranged,
                        __global const ushort *scanned, __global const uchar *slice, uint row_pitch,
                        ushort z) {
    const uint vectors = (l->width + SV_LANES - 1) / SV_LANES;
    const short16 inside = words16_of(pixels_of((vectors - 1) * SV_LANES, l->width));
    for (uint y = rows_before(l, s->row); y < rows_before(l, s->row + 1); y++) {
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

/* Finds the slices in which any of LANES pixels from x on was scanned. `scanned`: planes of the pixels'
 * ranges. */
static extent_t extent_of_pixels(const sv_wall_layout *l, const strip_t *s, uint x,
                                 __global const ushort *scanned) {
    short16 first = (short16)(NEVER), end = (short16)(0);
    for (uint at = x; at < min(x + LANES, l->width); at += SV_LANES) {
        const short16 inside = words16_of(pixels_of(at, l->width));
        for (uint y = s->first_row; y < s->first_row + s->rows; y++) {
            __global const ushort *range = scanned + (size_t)y * s->range_pitch + at;
            const short16 from = as_short16(vload16(0, range));
            const short16 to = as_short16(vload16(0, range + (size_t)l->height * s->range_pitch));
            const short16 is_scanned = inside & (from < to);
            first = min(first, select((short16)(NEVER), from, is_scanned));
            end = max(end, to & is_scanned);
        }
    }
    return extent_of((const short *)&first, (const short *)&end, SV_LANES);
}

static void find_extents(const sv_wall_layout *l, strip_t *s, __global const ushort *scanned) {
    s->any = (extent_t){0, 0};
    for (uint x = 0; x < l->width; x += LANES) {
        s->scanned[x / LANES] = extent_of_pixels(l, s, x, scanned);
        s->any = united(s->any, s->scanned[x / LANES]);
    }
}

/* Finds what the rows of pixels weigh for two rows of rays with these spans. */
static void weigh_rows(__global const sv_wall_span *spans, strip_t *s) {
    s->first_row = min(spans[0].first, spans[1].first);
    s->rows = max(spans[0].first + spans[0].count, spans[1].first + spans[1].count) - s->first_row;
    for (uint r = 0; r < 2; r++)
        for (uint y = 0; y < s->rows; y++) {
            const uint at =
                s->first_row + y - spans[r].first; /* wraps to a huge number in front of the span */
            s->weight[r][y] = at < spans[r].count ? spans[r].weight[at] * 0x10001u : 0u;
        }
}

/* Loads LANES voxels from `at` on. Rows that have fewer end with zeros. */
static u8l load_lanes(__global const uchar *at, bool narrow, uint width) {
    if (!narrow) return ((__global const u8l_unaligned *)at)->v;
    uchar16 parts[LANES / SV_LANES];
    for (uint i = 0; i < LANES / SV_LANES; i++) {
        const uint x = i * SV_LANES;
        parts[i] = (uchar16)(0);
        if (x < width) parts[i] = load_voxels(at, x, width) & pixels_of(x, width);
    }
    return *(const u8l *)parts;
}

/* Slices of one layer. */
typedef struct {
    __global const uchar *at[SV_WALL_BLOCK];
    uint count, row_pitch;
} slices_t;

static slices_t slices_from(const texture_t *t, uint first, uint count) {
    slices_t s = {.count = count, .row_pitch = t->row_pitch};
    for (uint i = 0; i < count; i++) s.at[i] = slice_of(t, first + i);
    return s;
}

/* Adds up pixels over the slices of a layer; padding counts as 0. */
static u16l add_up(const sv_wall_layout *l, const slices_t *from, size_t at, uint padding) {
    const bool narrow = l->width < LANES;
    u16l sum = (u16l)(0);
    if (!narrow && padding > 255) { /* a loop of its own is faster */
        for (uint i = 0; i < from->count; i++)
            sum += TO_U16(((__global const u8l_unaligned *)(from->at[i] + at))->v);
        return sum;
    }
    for (uint i = 0; i < from->count; i++) {
        u8l v = load_lanes(from->at[i] + at, narrow, l->width);
        if (padding <= 255) v &= AS_U8(v != (u8l)((uchar)padding));
        sum += TO_U16(v);
    }
    return sum;
}

/* The same of two slices, in rows that are wide and have no padding: most layers are such. */
static u16l add_two(const slices_t *from, size_t at) {
    return TO_U16(((__global const u8l_unaligned *)(from->at[0] + at))->v) +
           TO_U16(((__global const u8l_unaligned *)(from->at[1] + at))->v);
}

/* Sums up LANES columns from x on over rows of a strip, weighted for two rows of rays. */
static void sum_slices(const sv_wall_layout *l, const strip_t *s, const slices_t *from, extent_t rows, uint x,
                       u16l sums[2]) {
    const bool two = from->count == 2 && s->padding > 255 && l->width >= LANES;
    u16l upper = (u16l)(0), lower = upper;
    size_t at = (size_t)(s->first_row + rows.from) * from->row_pitch + x;
    for (uint y = rows.from; y < rows.to; y++, at += from->row_pitch) {
        const u16l sum = two ? add_two(from, at) : add_up(l, from, at, s->padding);
        upper += sum * REINTERPRET((u32h)(s->weight[0][y]), u16l);
        lower += sum * REINTERPRET((u32h)(s->weight[1][y]), u16l);
    }
    sums[0] = upper;
    sums[1] = lower;
}

/* Fetches a cache line of each row that follows these. */
static void fetch_below(const strip_t *s, const slices_t *from, extent_t rows, uint x) {
    for (uint y = rows.from; y < rows.to; y++)
        for (uint i = 0; i < from->count; i++)
            FETCH(from->at[i] + (size_t)(s->first_row + y + s->at_once) * from->row_pitch + x);
}

/* Adds rows of slices to the sums. `fresh`: they are the first ones of their layer. What remains at the end
 * of a row is summed with the pixels before it, and then moved to its place: to move every row would take
 * longer than all the rest. Layers in which none of LANES pixels was scanned are left out: wall_blocks clears
 * their blocks. */
static void add_rows(const sv_wall_layout *l, const layer_t *layer, const strip_t *s, const slices_t *slices,
                     extent_t rows, bool fresh, __global ushort *const sums[2]) {
    for (uint x = 0; x < l->width; x += LANES) {
        if (!is_scanned(layer, x / LANES, x / LANES)) continue;
        const uint from = x + LANES <= l->width || l->width < LANES ? x : l->width - LANES;
        u16l sum[2];
        sum_slices(l, s, slices, rows, from, sum);
        if (x % LINE_BYTES == 0) fetch_below(s, slices, rows, x);
        for (uint r = 0; r < 2; r++) {
            __global u16l *to = (__global u16l *)(sums[r] + x);
            if (from < x) {
                u16l moved[2];
                moved[0] = sum[r];
                moved[1] = (u16l)(0);
                sum[r] = ((const u16l_unaligned *)((const ushort *)moved + (x - from)))->v;
            }
            *to = fresh ? sum[r] : *to + sum[r];
        }
    }
}

/* Adds slices to the rows' sums. `fresh`: the first slice is the first of its layer. */
static void add_slices(const sv_wall_layout *l, const layer_t *layer, const strip_t *s,
                       const slices_t *slices, bool fresh, __global ushort *const sums[2]) {
    for (uint y = 0; y < s->rows; y += s->at_once)
        add_rows(l, layer, s, slices, (extent_t){y, min(y + s->at_once, s->rows)}, fresh && y == 0, sums);
    for (uint r = 0; r < 2; r++) { /* long before store_beside loads them with their neighbours */
        sums[r][-1] = sums[r][0];
        sums[r][l->width] = sums[r][l->width - 1];
    }
}

static layer_t layer_at(const sv_wall_layout *l, const strip_t *s, uint layer) {
    const uint from = layer * l->depth;
    return (layer_t){{from, min(from + l->depth, l->slices)}, s->ranged ? s->scanned : NULL};
}

/* Stores the means of a complete layer. */
static void store_layer(const sv_wall_layout *l, const strip_t *s, __global const sv_wall_span *spans,
                        uint complete, __global uchar *levels) {
    const layer_t layer = layer_at(l, s, complete);
    __global uchar *const to[2] = {levels + level_row(l, complete, 2 * s->row),
                                   levels + level_row(l, complete, 2 * s->row + 1)};
    store_means(l, &layer, spans, s->weights, s->taps, s->sums[complete % 2], to);
}

/* Adds a slab, and stores the layers that it completes but for the last one. `complete`: the layer whose
 * means are to be stored, l->layers if there is none. */
static uint add_slab(const sv_wall_layout *l, const strip_t *s, const texture_t *t, uint first_slice,
                     uint slice_count, __global const sv_wall_span *spans, uint complete,
                     __global uchar *levels) {
    for (uint i = 0; i < slice_count;) {
        const uint z = first_slice + i, at = z / l->depth;
        const layer_t layer = layer_at(l, s, at);
        const uint count = min(layer.slices.to - z, slice_count - i);
        const slices_t slices = slices_from(t, i, count);
        i += count;
        if (s->ranged && !overlap(s->any, layer.slices)) continue;
        add_slices(l, &layer, s, &slices, z == layer.slices.from, s->sums[at % 2]);
        if (z + count < layer.slices.to) continue;
        if (complete < l->layers) store_layer(l, s, spans, complete, levels);
        complete = at;
    }
    return complete;
}

/* One work item per row of cells. `ranged`: `scanned` has planes of the pixels' ranges. `spans`: of the
 * columns of rays, then of the rows. `sums`: words of 16 bits, padded pixels between margins twice for each
 * row of rays. `ranges`: two planes like those of `scanned`; they are not written without ranges and padding.
 */
__kernel void wall_downsample(__global const uchar *restrict slabs, sv_batch batch, uint row_pitch,
                              uint tiles_x, uint tile_w, uint tile_h, uint padding, uint ranged,
                              uint range_pitch, __global const ushort *restrict scanned, sv_wall_layout l,
                              __global const sv_wall_span *restrict spans, __global ushort *restrict sums,
                              __global ushort *restrict ranges, __global uchar *restrict levels) {
    const uint row = (uint)get_global_id(0), sum_words = round_up_to_lanes(l.width) + 2 * MEANS_MARGIN;
    strip_t s = {.row = row,
                 .padding = padding,
                 .ranged = ranged != 0,
                 .range_pitch = range_pitch,
                 .weights = weights_of(&l, spans),
                 .first = ranges,
                 .end = ranges + (size_t)l.height * range_pitch};
    weigh_rows(spans + l.columns + 2 * row, &s);
    s.taps = taps_of(&l, spans, s.weights);
    s.at_once = s.rows < 2 * FETCHED_ROWS ? s.rows : FETCHED_ROWS;
    for (uint i = 0; i < 4; i++)
        s.sums[i / 2][i % 2] = sums + (size_t)(4 * row + i) * sum_words + MEANS_MARGIN;
    if (batch.first_slice == 0 && (ranged || padding <= 255)) begin_ranges(&l, &s, ranged != 0, scanned);
    if (ranged) find_extents(&l, &s, scanned);
    uint first_slice = batch.first_slice, complete = l.layers;
    for (uint n = 0; n < batch.count; n++) {
        const texture_t t = {slabs + batch.offset[n], row_pitch, tiles_x, tile_w, tile_h};
        for (uint i = 0; padding <= 255 && i < batch.slices[n]; i++)
            note_ranges(&l, &s, ranged != 0, scanned, slice_of(&t, i), row_pitch, (ushort)(first_slice + i));
        complete = add_slab(&l, &s, &t, first_slice, batch.slices[n], spans, complete, levels);
        first_slice += batch.slices[n];
    }
    if (complete < l.layers) store_layer(&l, &s, spans, complete, levels);
}
