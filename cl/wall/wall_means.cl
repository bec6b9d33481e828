/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, brightness: means of boxes, their histogram, and the largest of the means beside a ray.
 *
 * A row of rays is walked front to back. For every slice the sums of 2 ry + 1 rows, then of 2 rx + 1 columns
 * are put into a ring of 2 rz + 1 lines; what enters the ring is added to the sums of the boxes, and what
 * leaves it is taken from them.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

#define WORD_MARGIN 32 /* words before and behind a line of sums: more than SV_WALL_REACH */
#define BYTE_MARGIN 96 /* bytes before and behind a line of means: SV_WALL_BESIDE */

/* Division by the box by a product: (n * factor) >> (16 + shift), or >> 32 if that is not exact. */
typedef struct {
    uint rounding, factor, shift;
    bool narrow; /* 16 bits do */
} divider_t;

/* What a row keeps while it is walked, in `lines`: words of 16 bits, whole vectors. Lines that are read at
 * other places than they were written at are two, taken in turns: a vector that was just stored in parts is
 * slow to load. */
typedef struct {
    __global ushort *columns[2]; /* sums of rows, between margins */
    __global u16l *ring;
    __global u16l *sums; /* of the boxes; if they do not fit into 16 bits, their lower, then upper halves */
    __global uchar *means[2]; /* between margins */
} row_t;

/* Upper half of a product of two times 32 bits. */
static u32l mul_hi32(u32l a, uint b) {
    u32l high;
    for (uint i = 0; i < LANES; i++) ((uint *)&high)[i] = mul_hi(((const uint *)&a)[i], b);
    return high;
}

static divider_t divider_of(const sv_wall_layout *l) {
    const uint box = (2 * l->mean[0] + 1) * (2 * l->mean[1] + 1) * (2 * l->mean[2] + 1);
    divider_t d = {.rounding = box / 2, .factor = 1, .shift = 0, .narrow = box <= 256};
    if (d.narrow && box > 1) {
        while (2u << d.shift < box) d.shift++;
        const uint one = 1u << (16 + d.shift);
        d.factor = one / box + 1; /* the box is odd, so this is rounded up */
        d.narrow = (ulong)(255 * box + d.rounding) * (d.factor * box - one) < one;
    }
    if (!d.narrow) d.factor = (uint)((1ul << 32) / box) + 1;
    return d;
}

/* The slices at which the boxes of row y were scanned all over. */
static void find_boxes(const sv_wall_layout *l, __global ushort *rays, uint y) {
    const uint vectors = padded_width_of(l) / LANES, rx = l->mean[0], ry = l->mean[1];
    __global ushort *box_first = (__global ushort *)ray_row(rays, l, RAY_BOX_FIRST, y);
    __global ushort *box_end = (__global ushort *)ray_row(rays, l, RAY_BOX_END, y);
    const bool inside = y >= ry && y + ry < l->height;
    for (uint x = 0; x < vectors * LANES; x++) {
        uint first = 0, end = l->slices;
        if (!inside || x < rx || x + rx >= l->width) end = 0;
        for (uint v = y - ry; end > 0 && v <= y + ry; v++) {
            __global const ushort *ends = (__global const ushort *)ray_row(rays, l, RAY_END, v);
            __global const ushort *firsts = (__global const ushort *)ray_row(rays, l, RAY_FIRST, v);
            for (uint u = x - rx; u <= x + rx; u++) {
                first = max(first, (uint)firsts[u]);
                end = min(end, (uint)ends[u]);
            }
        }
        box_first[x] = (ushort)(first + l->mean[2]);
        box_end[x] = (ushort)(end > l->mean[2] ? end - l->mean[2] : 0);
    }
}

/* Sums of the rows of the box in slice z. */
static void sum_rows_of(const sv_wall_layout *l, __global const u8l *voxels, uint z, uint y, const row_t *r) {
    const uint vectors = padded_width_of(l) / LANES, ry = l->mean[1];
    const uint y0 = y - min(y, ry), y1 = min(y + ry, l->height - 1);
    __global u16l *columns = (__global u16l *)(r->columns[z & 1] + WORD_MARGIN);
    __global const u8l *from = voxels + ((size_t)z * l->height + y0) * vectors;
    for (uint x = 0; x < vectors; x++) {
        u16l sum = TO_U16(from[x]);
        for (uint v = 1; v <= y1 - y0; v++) sum += TO_U16(from[v * vectors + x]);
        columns[x] = sum;
    }
}

static u16l sum_columns(__global const ushort *columns, uint x, uint rx) {
    __global const ushort *at = columns + WORD_MARGIN + x * LANES;
    u16l sum = ((__global const u16l_anywhere *)at)->v;
    for (uint k = 1; k <= rx; k++)
        sum += ((__global const u16l_anywhere *)(at - k))->v + ((__global const u16l_anywhere *)(at + k))->v;
    return sum;
}

/* Means of 16 boxes, whose sums change by `more` - `less`. */
static u8l mean_of(const divider_t *d, __global u16l *sums, uint x, uint vectors, u16l more, u16l less) {
    if (d->narrow) {
        const u16l sum = sums[x] + more - less;
        sums[x] = sum;
        if (d->rounding == 0) return TO_U8(sum);
        const u32l product = TO_U32(sum + (ushort)d->rounding) * TO_U32((u16l)((ushort)d->factor));
        return TO_U8(TO_U16(product >> 16u) >> (ushort)d->shift);
    }
    u32l sum = TO_U32(sums[x]) + (TO_U32(sums[vectors + x]) << 16u);
    sum += TO_U32(more);
    sum -= TO_U32(less);
    sums[x] = TO_U16(sum & 0xffffu);
    sums[vectors + x] = TO_U16(sum >> 16u);
    return TO_U8(mul_hi32(sum + d->rounding, d->factor));
}

/* Counts 16 means where the mask is set; four histograms, so that equal neighbours do not wait. */
static void count(uint histogram[4][256], u8l means, i16l mask) {
    if (!some_words(~mask)) {
        const ulong *packed = (const ulong *)&means;
        for (uint k = 0; k < LANES / 8; k += 2) {
            ulong a = packed[k], b = packed[k + 1];
            for (uint i = 0; i < 4; i++) {
                histogram[0][a & 255]++;
                histogram[1][b & 255]++;
                histogram[2][(a >> 8) & 255]++;
                histogram[3][(b >> 8) & 255]++;
                a >>= 16;
                b >>= 16;
            }
        }
        return;
    }
    if (!some_words(mask)) return;
    const uchar *lanes = (const uchar *)&means;
    const short *wanted = (const short *)&mask;
    for (uint i = 0; i < LANES; i++) histogram[0][lanes[i]] += wanted[i] != 0;
}

/* The largest of a row's bytes and of those up to `before` and `behind` further on, `stride` apart: as many
 * as a row of voxels has. */
static void largest_of_row(const sv_wall_layout *l, __global const uchar *at, int before, int behind,
                           int stride, __global uchar *to) {
    for (uint x = 0; x < padded_width_of(l); x += LANES) {
        u8l most = ((__global const u8l_anywhere *)(at + x))->v;
        for (int k = 1; k <= before; k++) {
            const u8l other = ((__global const u8l_anywhere *)(at + x - k * stride))->v;
            most = MOST(most, other);
        }
        for (int k = 1; k <= behind; k++) {
            const u8l other = ((__global const u8l_anywhere *)(at + x + k * stride))->v;
            most = MOST(most, other);
        }
        *(__global u8l *)(to + x) = most;
    }
}

/* Lanes of the pixels that the last vector of a row has. */
static u8l last_pixels(const sv_wall_layout *l) {
    const uint x = padded_width_of(l) - LANES;
    u8l mask;
    for (uint i = 0; i < LANES; i++) ((uchar *)&mask)[i] = x + i < l->width ? 255 : 0;
    return mask;
}

static row_t row_of(const sv_wall_layout *l, __global ushort *lines, uint line_words, uint y) {
    const uint vectors = padded_width_of(l) / LANES, ring = (2 * l->mean[2] + 1) * vectors;
    lines += (size_t)y * line_words;
    for (uint i = 0; i < line_words; i++) lines[i] = 0;
    row_t r;
    r.ring = (__global u16l *)lines;
    r.sums = r.ring + ring;
    r.columns[0] = (__global ushort *)(r.sums + 2 * vectors);
    r.columns[1] = r.columns[0] + 2 * WORD_MARGIN + vectors * LANES;
    r.means[0] = (__global uchar *)(r.columns[1] + 2 * WORD_MARGIN + vectors * LANES);
    r.means[1] = r.means[0] + 2 * BYTE_MARGIN + vectors * LANES;
    return r;
}

/* Scanned rays of a row. */
static uint count_rays(const sv_wall_layout *l, __global ushort *rays, uint y) {
    __global const ushort *first = (__global const ushort *)ray_row(rays, l, RAY_FIRST, y);
    __global const ushort *end = (__global const ushort *)ray_row(rays, l, RAY_END, y);
    uint count = 0;
    for (uint x = 0; x < l->width; x++) count += end[x] > first[x];
    return count;
}

/* The means of slice z of a row, with what entered and left its boxes; their histogram. */
static void means_of_slice(const sv_wall_layout *l, const divider_t *divider, const row_t *r, uint next,
                           __global const u16l *box_first, __global const u16l *box_end, u8l last,
                           uint histogram[4][256]) {
    const uint vectors = padded_width_of(l) / LANES, rz = l->mean[2];
    const ushort z = (ushort)(next - min(next, rz));
    __global u16l *line = r->ring + next % (2 * rz + 1) * vectors;
    __global u8l *means = (__global u8l *)(r->means[z & 1] + BYTE_MARGIN);
    for (uint x = 0; x < vectors; x++) {
        const u16l less = line[x];
        const u16l more = next < l->slices ? sum_columns(r->columns[next & 1], x, l->mean[0]) : (u16l)(0);
        line[x] = more;
        u8l mean = mean_of(divider, r->sums, x, vectors, more, less);
        if (next < rz) continue;
        count(histogram, mean, (box_first[x] <= z) & (box_end[x] > z));
        if (x + 1 == vectors) mean &= last;
        means[x] = mean;
    }
}

static void beside_of_slice(const sv_wall_layout *l, const row_t *r, uint z, uint y, __global uchar *beside) {
    largest_of_row(l, r->means[z & 1] + BYTE_MARGIN, (int)l->beside[0], (int)l->beside[0], 1,
                   beside + ((size_t)z * l->height + y) * padded_width_of(l));
}

/* One work item per row. `lines`: line_words a row. `beside`: the largest means of a row beside every ray. */
__kernel void wall_means(sv_wall_layout l, uint line_words, __global const u8l *restrict voxels,
                         __global ushort *restrict rays, __global ushort *restrict lines,
                         __global uchar *restrict beside, __global uint *restrict histograms) {
    const uint y = (uint)get_global_id(0), rz = l.mean[2];
    const divider_t divider = divider_of(&l);
    const row_t r = row_of(&l, lines, line_words, y);
    const u8l last = last_pixels(&l);
    uint histogram[4][256];
    for (uint i = 0; i < 256; i++) histogram[0][i] = histogram[1][i] = histogram[2][i] = histogram[3][i] = 0;
    find_boxes(&l, rays, y);
    sum_rows_of(&l, voxels, 0, y, &r);
    for (uint next = 0; next < l.slices + rz; next++) {
        if (next + 1 < l.slices) sum_rows_of(&l, voxels, next + 1, y, &r);
        means_of_slice(&l, &divider, &r, next, ray_row(rays, &l, RAY_BOX_FIRST, y),
                       ray_row(rays, &l, RAY_BOX_END, y), last, histogram);
        if (next > rz) beside_of_slice(&l, &r, next - rz - 1, y, beside);
    }
    beside_of_slice(&l, &r, l.slices - 1, y, beside);
    histograms += (size_t)y * HISTOGRAM_WORDS;
    histograms[HISTOGRAM_RAYS] = count_rays(&l, rays, y);
    for (uint i = 0; i < 256; i++)
        histograms[i] = histogram[0][i] + histogram[1][i] + histogram[2][i] + histogram[3][i];
}

/* One work item per slice: the largest of the rows beside every ray, from those of single rows. */
__kernel void wall_brightest(sv_wall_layout l, __global const uint *restrict info,
                             __global const uchar *restrict beside, __global uchar *restrict bright) {
    const uint z = (uint)get_global_id(0), width = padded_width_of(&l), reach = l.beside[1];
    const size_t slice = (size_t)z * l.height * width;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint y = 0; y < l.height; y++) {
        const size_t row = slice + (size_t)y * width;
        largest_of_row(&l, beside + row, (int)min(reach, y), (int)min(reach, l.height - 1 - y), (int)width,
                       bright + row);
    }
}
