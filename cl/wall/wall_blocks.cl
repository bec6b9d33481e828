/* SPDX-License-Identifier: MIT */
/*
 * Blocks of a camera or along the beams: which of them were scanned, their histogram, and their dilation
 * along x.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_BEAMS_CLH
#include "wall/wall_beams.clh"
#endif
#ifndef SV_WALL_HISTOGRAM_CLH
#include "wall/wall_histogram.clh"
#endif
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
#endif

/* Ranges of 16 pixels or rays: the latest first slice, and the earliest end. */
typedef struct {
    ushort16 first, end;
} range16_t;

static range16_t intersect(range16_t a, ushort16 first, ushort16 end) {
    return (range16_t){max(a.first, first), min(a.end, end)};
}

static range16_t whole_range(const sv_wall_layout *l) {
    return (range16_t){(ushort16)(0), (ushort16)((ushort)l->slices)};
}

/* Intersects the ranges of pixels down the blocks of a row of rays. `pixels`: two lines of `pitch` words, the
 * first slices and the ends, with margins. */
static void intersect_rows(const sv_wall_layout *l, const sv_wall_span *along, uint pitch,
                           __global const ushort *ranges, __global ushort *const pixels[2]) {
    for (uint x = 0; x < pitch; x += SV_LANES) {
        range16_t r = whole_range(l);
        for (uint y = along->first; y < along->first + along->count; y++) {
            __global const ushort *at = ranges + (size_t)y * pitch + x;
            r = intersect(r, vload16(0, at), vload16(0, at + (size_t)l->height * pitch));
        }
        *(__global ushort16 *)(pixels[0] + x) = r.first;
        *(__global ushort16 *)(pixels[1] + x) = r.end;
    }
}

/* Intersects these ranges across the blocks of 16 rays from x on. */
static range16_t intersect_columns(const sv_wall_layout *l, __global const sv_wall_span *spans, uint x,
                                   __global ushort *const pixels[2]) {
    __global const sv_wall_taps *near =
        (__global const sv_wall_taps *)(spans + l->columns + l->rows) + x / SV_WALL_TOGETHER;
    range16_t r = whole_range(l);
    for (uint k = 0; k < near->count; k++) {
        const ushort16 touches =
            as_ushort16(words16_of(as_uchar16(vload16(0, near->weight[k]) != (uchar16)(0))));
        const ushort16 end = vload16(0, pixels[1] + near->shift + (int)k);
        r = intersect(r, vload16(0, pixels[0] + near->shift + (int)k) & touches, end | ~touches);
    }
    for (uint i = 0; near->count == 0 && i < SV_WALL_TOGETHER; i++) {
        __global const sv_wall_span *s = spans + min(x + i, l->columns - 1);
        ushort first = 0, end = (ushort)l->slices;
        for (uint at = s->first; at < s->first + s->count; at++) {
            first = max(first, pixels[0][at]);
            end = min(end, pixels[1][at]);
        }
        ((ushort *)&r.first)[i] = first;
        ((ushort *)&r.end)[i] = end;
    }
    return r;
}

/* Divides rounding down. Half is added so that no quotient lies nearer to the next whole number than float32
 * rounds. */
static ushort16 divided(ushort16 slices, uint by) {
    return convert_ushort16((convert_float16(slices) + 0.5f) * (1.0f / (float)by));
}

/* Finds the ranges of a row of rays, in layers. `pixels`: room for two lines of pixels, with margins. Returns
 * how many of the rays were scanned. */
static uint find_ranges(const sv_wall_layout *l, uint row, uint bounded, uint pitch,
                        __global const sv_wall_span *spans, __global const ushort *ranges,
                        __global ushort *const pixels[2], __global ushort *rays) {
    __global ushort *first = (__global ushort *)ray_row(rays, l, RAY_FIRST, row);
    __global ushort *end = (__global ushort *)ray_row(rays, l, RAY_END, row);
    const sv_wall_span along = spans[l->columns + row];
    uint count = 0;
    if (bounded) intersect_rows(l, &along, pitch, ranges, pixels);
    for (uint x = 0; x < padded_columns_of(l); x += SV_LANES) {
        range16_t r = {(ushort16)(0), (ushort16)((ushort)l->layers)};
        if (bounded && x < l->columns) {
            const range16_t slices = intersect_columns(l, spans, x, pixels);
            r.first = divided(slices.first + (ushort)(l->depth - 1), l->depth);
            r.end = select(divided(slices.end, l->depth), (ushort16)((ushort)l->layers),
                           slices.end == (ushort16)((ushort)l->slices));
        }
        const ushort16 inside = as_ushort16(words16_of(pixels_of(min(x, l->columns), l->columns)));
        const ushort16 scanned = as_ushort16(r.first < r.end) & inside;
        *(__global ushort16 *)(first + x) = r.first & scanned;
        *(__global ushort16 *)(end + x) = r.end & scanned;
        const ushort16 ones = scanned & (ushort16)(1);
        for (uint i = 0; i < SV_LANES; i++) count += ((const ushort *)&ones)[i];
    }
    return count;
}

/* Averages LANES levels with those behind them, rounding half up. */
static u8l mean_at(__global const uchar *at, __global const uchar *behind) {
    const u16l sum = TO_U16(*(__global const u8l *)at) + TO_U16(*(__global const u8l *)behind);
    return TO_U8((sum + (ushort)1) >> (ushort)1);
}

/* Finds the maximum of these means in every cell of row `row` of layer `z`. */
static void maximum_of_cells(const sv_wall_layout *l, __global const uchar *levels, uint z, uint row,
                             __global uchar *line) {
    for (uint x = 0; x < padded_columns_of(l); x += LANES) {
        const u8l above =
            mean_at(levels + level_row(l, z, 2 * row) + x, levels + level_row(l, z + 1, 2 * row) + x);
        const u8l below =
            mean_at(levels + level_row(l, z, 2 * row + 1) + x, levels + level_row(l, z + 1, 2 * row + 1) + x);
        const u16h pairs = REINTERPRET(MAXIMUM(above, below), u16h); /* neighbours share a word */
        const u16h left = pairs & (ushort)255, right = pairs >> (ushort)8;
        *(__global u8h *)(line + x / 2) = HALF_TO_U8(MAXIMUM(left, right));
    }
}

/* Grey dilation along x of a line of cells. */
static void dilate_line(const sv_wall_layout *l, __global const uchar *line, __global uchar *to) {
    const int reach = (int)l->dilation[0];
    for (int x = 0; x < (int)padded_cells_of(l); x += LANES) {
        u8l maximum = *(__global const u8l *)(line + x);
        for (int k = 1; k <= reach; k++) {
            const u8l left = ((__global const u8l_unaligned *)(line + x - k))->v;
            const u8l right = ((__global const u8l_unaligned *)(line + x + k))->v;
            const u8l both = MAXIMUM(left, right);
            maximum = MAXIMUM(maximum, both);
        }
        *(__global u8l *)(to + x) = maximum;
    }
}

/* Sets the levels of a row of rays in layer `z` to 0 where it was not scanned, and counts those of inner
 * rays. */
static void mask_row(const sv_wall_layout *l, __global ushort *rays, uint z, uint row, __global uchar *levels,
                     uint histogram[4][256]) {
    const i16l at = (i16l)((short)z);
    __global const i16l *first = (__global const i16l *)ray_row(rays, l, RAY_FIRST, row);
    __global const i16l *end = (__global const i16l *)ray_row(rays, l, RAY_END, row);
    __global u8l *here = (__global u8l *)(levels + level_row(l, z, row));
    const bool counts = !l->smoothed && is_inner(row, l->rows);
    for (uint x = 0; x < vectors_of(l); x++) {
        const i16l scanned = (first[x] <= at) & (end[x] > at);
        const u8l level = here[x] & bytes_of(scanned);
        here[x] = level;
        if (counts) count_levels(histogram, level, scanned, x * LANES, l->columns);
    }
}

/* Masks and counts the levels of a row of cells, whose ranges are known, and dilates their means along x.
 * `lines`: room for three lines of cells, between margins. */
static void finish_row(const sv_wall_layout *l, uint row, __global ushort *rays, __global uchar *levels,
                       __global uchar *lines, __global uchar *row_maxima, uint histogram[4][256]) {
    /* three lines alternate, for a vector that was just stored is slow to load in parts */
    const uint line_pitch = padded_cells_of(l) + 2 * MARGIN;
    clear_bytes(lines, 3 * line_pitch);
    lines += MARGIN;
    const extent_t scanned = extent_of_row(l, rays, row);
    /* A level counts with that behind it, so the layer in front of the scan has maxima, too. */
    const extent_t bright = {scanned.from - min(scanned.from, 1u), scanned.to};
    const uint masked_to = min(bright.to + 1, l->layers);
    clear_others(l, bright, row_maxima + cell_row(l, 0, row), padded_cells_of(l));
    for (uint z = bright.from; z < bright.to + 2; z++) {
        for (uint r = 0; z < masked_to && r < 2; r++) mask_row(l, rays, z, 2 * row + r, levels, histogram);
        if (z > bright.from + 1)
            dilate_line(l, lines + (z - 2) % 3 * line_pitch, row_maxima + cell_row(l, z - 2, row));
        if (z > bright.from && z <= bright.to)
            maximum_of_cells(l, levels, z - 1, row, lines + (z - 1) % 3 * line_pitch);
    }
}

/* One work item per row of cells. Levels of blocks that were not scanned become 0; where pixels have no
 * ranges, all were. `bounded`: the pixels have ranges. `row_maxima`: the means' dilation along x. `scratch`:
 * scratch_words words of 32 bits for each row. If wall_smooth follows, that kernel counts the levels. */
__kernel void wall_blocks(sv_wall_layout l, uint bounded, uint pitch, uint scratch_words,
                          __global const sv_wall_span *restrict spans, __global const ushort *restrict ranges,
                          __global uchar *restrict levels, __global ushort *restrict rays,
                          __global uint *restrict scratch, __global uchar *restrict row_maxima,
                          __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0);
    __global uchar *lines = (__global uchar *)(scratch + (size_t)row * scratch_words);
    __global ushort *const pixels[2] = {(__global ushort *)lines + MARGIN,
                                        (__global ushort *)lines + pitch + 3 * MARGIN};
    uint histogram[4][256];
    clear_counts(histogram);
    histograms += (size_t)row * HISTOGRAM_WORDS;
    histograms[HISTOGRAM_RAYS] = find_ranges(&l, 2 * row, bounded, pitch, spans, ranges, pixels, rays) +
                                 find_ranges(&l, 2 * row + 1, bounded, pitch, spans, ranges, pixels, rays);
    for (uint r = 2 * row; bounded && r < 2 * row + 2; r++)
        clear_others(&l, extent_of_row(&l, rays, row), levels + level_row(&l, 0, r), level_pitch_of(&l));
    finish_row(&l, row, rays, levels, lines, row_maxima, histogram);
    if (!l.smoothed) store_counts(histogram, histograms);
}

/* 16 neighbouring beams of a plane, as in beam_t. */
typedef struct {
    int16 from[3], step[3];
    uint16 first;
} beams16_t;

/* Those from column `line` on; what is no line has no sample. */
static void find_beams(const sv_wall_grid *g, __global const uint *tables, uint line, uint plane,
                       beams16_t *out) {
    ROLLED_LOADS
    for (uint i = 0; i < SV_LANES; i++) {
        const beam_t b = beam_of(g, tables, min(line + i, g->lines - 1), plane);
        for (uint a = 0; a < 3; a++) {
            ((int *)&out->from[a])[i] = b.from[a];
            ((int *)&out->step[a])[i] = b.step[a];
        }
        ((uint *)&out->first)[i] = line + i < g->lines ? b.first : g->samples;
    }
}

typedef struct __attribute__((packed)) {
    uint v;
} uint_unaligned;

/* Loads neighbouring blocks at 16 places: the one behind is the higher byte. Words of 32 bits with signed
 * indices become gathers where the processor has them; shorter words are loaded one by one. */
static uint16 load_pairs(__global const uchar *camera, uint16 places) {
    uint16 words;
    TABLE_LOADS
    for (uint i = 0; i < SV_LANES; i++)
        ((uint *)&words)[i] = ((__global const uint_unaligned *)(camera + ((const int *)&places)[i]))->v;
    return words & 0xffffu;
}

/* Interpolates between such neighbours; a block that was not scanned counts as the nearest one. */
static uint16 between_pair(uint16 pairs, uint16 part, uint16 nearest) {
    const uint16 low = pairs & 255u, high = pairs >> 8u;
    return ((uint)SV_WALL_PART_ONE - part) * select(low, nearest, low == 0u) +
           part * select(high, nearest, high == 0u);
}

/* Returns the levels at sample k of 16 beams, linear between the eight blocks around each; 0 where the
 * nearest was not scanned. Another one that was not counts as the nearest. `camera`: as wall_blocks leaves
 * it. */
static uint16 levels_on_beams(const sv_wall_grid *g, __global const uchar *camera, const beams16_t *b,
                              uint k) {
    const uint sides[3] = {g->columns, g->rows, g->layers}, one = SV_WALL_PART_ONE;
    const uint row = (uint)camera_row_pitch(g), layer = (uint)camera_layer_pitch(g);
    int16 inside = b->first <= (uint16)(k);
    uint16 low[3], part[3];
    for (uint a = 0; a < 3; a++) {
        const int16 at = b->from[a] + (int)k * b->step[a];
        inside &= (IN_BLOCKS(at, sides[a]));
        /* Vectors: oclgrind's clamp takes a scalar for the first lane only. */
        const int16 last = (int16)((int)((sides[a] - 1) << SV_WALL_POSITION_BITS) - 1);
        const uint16 clamped = as_uint16(clamp(at, (int16)(0), last));
        low[a] = clamped >> (uint)SV_WALL_POSITION_BITS;
        part[a] = (clamped & (uint)((1 << SV_WALL_POSITION_BITS) - 1)) * one >> (uint)SV_WALL_POSITION_BITS;
    }
    if (!any(inside)) return (uint16)(0);
    const uint16 at = SV_WALL_BESIDE + low[1] * row + low[2] * layer + low[0];
    const uint16 here = load_pairs(camera, at), below = load_pairs(camera, at + row);
    const uint16 behind = load_pairs(camera, at + layer), both = load_pairs(camera, at + row + layer);
    const int16 up_y = part[1] >= one / 2, up_z = part[2] >= one / 2;
    const uint16 pair = select(select(here, below, up_y), select(behind, both, up_y), up_z);
    const uint16 nearest = select(pair & 255u, pair >> 8u, part[0] >= one / 2);
    const uint16 near = (one - part[1]) * between_pair(here, part[0], nearest) +
                        part[1] * between_pair(below, part[0], nearest);
    const uint16 far = (one - part[1]) * between_pair(behind, part[0], nearest) +
                       part[1] * between_pair(both, part[0], nearest);
    const uint16 sum = (one - part[2]) * near + part[2] * far;
    return select((uint16)(0), (sum + SV_WALL_PARTS / 2) / SV_WALL_PARTS, inside & (nearest > 0u));
}

/* Gathers a plane of beams. A beam was scanned from its first sample that is not black to its last. Returns
 * how many were. */
static uint gather_plane(const sv_wall_layout *l, const sv_wall_grid *g, __global const uint *tables,
                         __global const uchar *camera, uint plane, __global uchar *levels,
                         __global ushort *rays) {
    uint count = 0;
    for (uint line = 0; line < padded_columns_of(l); line += SV_LANES) {
        ushort16 first = (ushort16)(0), end = (ushort16)(0);
        beams16_t beams;
        if (line < l->columns) find_beams(g, tables, line, plane, &beams);
        for (uint k = 0; line < l->columns && k < l->layers; k++) {
            const ushort16 found = convert_ushort16(levels_on_beams(g, camera, &beams, k));
            *(__global uchar16 *)(levels + level_row(l, k, plane) + line) = convert_uchar16(found);
            const short16 scanned = found > (ushort)0;
            first = select(first, (ushort16)((ushort)k), scanned & (end == (ushort)0));
            end = select(end, (ushort16)((ushort)(k + 1)), scanned);
        }
        *(__global ushort16 *)(rays + block_row(l, RAY_FIRST, plane) + line) = first;
        *(__global ushort16 *)(rays + block_row(l, RAY_END, plane) + line) = end;
        for (uint i = 0; i < SV_LANES; i++) count += ((const ushort *)&end)[i] > 0;
    }
    return count;
}

/* One work item per row of cells of a grid along the beams: the levels at its samples, from those of a
 * camera. Everything else as wall_blocks. */
__kernel void wall_gather(sv_wall_layout l, sv_wall_grid g, uint scratch_words,
                          __global const uint *restrict tables, __global const uchar *restrict camera,
                          __global uchar *restrict levels, __global ushort *restrict rays,
                          __global uint *restrict scratch, __global uchar *restrict row_maxima,
                          __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0);
    uint histogram[4][256], count = 0;
    clear_counts(histogram);
    for (uint plane = 2 * row; plane < 2 * row + 2; plane++)
        count += gather_plane(&l, &g, tables, camera, plane, levels, rays);
    finish_row(&l, row, rays, levels, (__global uchar *)(scratch + (size_t)row * scratch_words), row_maxima,
               histogram);
    histograms += (size_t)row * HISTOGRAM_WORDS;
    store_counts(histogram, histograms);
    histograms[HISTOGRAM_RAYS] = count;
}
