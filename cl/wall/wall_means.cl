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

#define WORD_MARGIN SV_LANES /* words before and behind a line of sums: more than SV_WALL_REACH */
#define BYTE_MARGIN 80       /* bytes before and behind a line of means: SV_WALL_BESIDE */

/* Division by the box by a product: (n * factor) >> (16 + shift), or >> 32 if that is not exact. */
typedef struct {
    uint rounding, factor, shift;
    bool narrow; /* 16 bits do */
} divider_t;

/* What a row keeps while it is walked, in `lines`: words of 16 bits, whole vectors. */
typedef struct {
    __global ushort *columns; /* sums of rows, between margins */
    __global ushort16 *ring;
    __global ushort16
        *sums;             /* of the boxes; if they do not fit into 16 bits, their lower, then upper halves */
    __global uchar *means; /* between margins */
} row_t;

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
static void find_boxes(const sv_wall_layout *l, __global ushort16 *rays, uint y) {
    const uint vectors = padded_width_of(l) / SV_LANES, rx = l->mean[0], ry = l->mean[1];
    __global ushort *box_first = (__global ushort *)ray_row(rays, l, RAY_BOX_FIRST, y);
    __global ushort *box_end = (__global ushort *)ray_row(rays, l, RAY_BOX_END, y);
    const bool inside = y >= ry && y + ry < l->height;
    for (uint x = 0; x < vectors * SV_LANES; x++) {
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
static void sum_rows_of(const sv_wall_layout *l, __global const uchar16 *voxels, uint z, uint y,
                        const row_t *r) {
    const uint vectors = padded_width_of(l) / SV_LANES, ry = l->mean[1];
    const uint y0 = y - min(y, ry), y1 = min(y + ry, l->height - 1);
    __global ushort16 *columns = (__global ushort16 *)(r->columns + WORD_MARGIN);
    __global const uchar16 *from = voxels + ((size_t)z * l->height + y0) * vectors;
    for (uint x = 0; x < vectors; x++) {
        ushort16 sum = convert_ushort16(from[x]);
        for (uint v = 1; v <= y1 - y0; v++) sum += convert_ushort16(from[v * vectors + x]);
        columns[x] = sum;
    }
}

static ushort16 sum_columns(const row_t *r, uint x, uint rx) {
    __global const ushort *at = r->columns + WORD_MARGIN + x * SV_LANES;
    ushort16 sum = ((__global const words_anywhere *)at)->v;
    for (uint k = 1; k <= rx; k++)
        sum +=
            ((__global const words_anywhere *)(at - k))->v + ((__global const words_anywhere *)(at + k))->v;
    return sum;
}

/* Means of 16 boxes, whose sums change by `more` - `less`. */
static uchar16 mean_of(const divider_t *d, __global ushort16 *sums, uint x, uint vectors, ushort16 more,
                       ushort16 less) {
    if (d->narrow) {
        const ushort16 sum = sums[x] + more - less;
        sums[x] = sum;
        if (d->rounding == 0) return convert_uchar16(sum);
        const uint16 product = convert_uint16(sum + (ushort)d->rounding) * d->factor;
        return convert_uchar16(convert_ushort16(product >> 16u) >> (ushort)d->shift);
    }
    uint16 sum = convert_uint16(sums[x]) + (convert_uint16(sums[vectors + x]) << 16u);
    sum += convert_uint16(more);
    sum -= convert_uint16(less);
    sums[x] = convert_ushort16(sum & 0xffffu);
    sums[vectors + x] = convert_ushort16(sum >> 16u);
    return convert_uchar16(mul_hi(sum + d->rounding, (uint16)(d->factor)));
}

/* Counts 16 means where the mask is set; four histograms, so that equal neighbours do not wait. */
static void count(uint histogram[4][256], uchar16 means, short16 mask) {
    if (!some_words(~mask)) {
        const ulong2 packed = as_ulong2(means);
        ulong a = packed.s0, b = packed.s1;
        for (uint i = 0; i < 4; i++) {
            histogram[0][a & 255]++;
            histogram[1][b & 255]++;
            histogram[2][(a >> 8) & 255]++;
            histogram[3][(b >> 8) & 255]++;
            a >>= 16;
            b >>= 16;
        }
        return;
    }
    if (!some_words(mask)) return;
    const uchar *lanes = (const uchar *)&means;
    const short *wanted = (const short *)&mask;
    for (uint i = 0; i < SV_LANES; i++) histogram[0][lanes[i]] += wanted[i] != 0;
}

static wide_bytes larger(wide_bytes a, wide_bytes b) {
    return a > b ? a : b;
}

/* The largest of WIDE bytes and of those up to `reach` further on both sides, `stride` apart. */
static void largest_wide(__global const uchar *at, uint before, uint behind, int stride, __global uchar *to) {
    wide_bytes most = ((__global const wide_anywhere *)at)->v;
    for (int k = 1; k <= (int)before; k++)
        most = larger(most, ((__global const wide_anywhere *)(at - k * stride))->v);
    for (int k = 1; k <= (int)behind; k++)
        most = larger(most, ((__global const wide_anywhere *)(at + k * stride))->v);
    ((__global wide_anywhere *)to)->v = most;
}

/* The same for 16. */
static void largest_narrow(__global const uchar *at, uint before, uint behind, int stride,
                           __global uchar *to) {
    uchar16 most = ((__global const bytes_anywhere *)at)->v;
    for (int k = 1; k <= (int)before; k++)
        most = max(most, ((__global const bytes_anywhere *)(at - k * stride))->v);
    for (int k = 1; k <= (int)behind; k++)
        most = max(most, ((__global const bytes_anywhere *)(at + k * stride))->v);
    *(__global uchar16 *)to = most;
}

/* The largest of a row's bytes and those beside them: as many as a row of voxels has. */
static void largest_of_row(const sv_wall_layout *l, __global const uchar *at, uint before, uint behind,
                           int stride, __global uchar *to) {
    const uint width = padded_width_of(l);
    uint x = 0;
    for (; x + WIDE <= width; x += WIDE) largest_wide(at + x, before, behind, stride, to + x);
    for (; x < width; x += SV_LANES) largest_narrow(at + x, before, behind, stride, to + x);
}

static row_t row_of(const sv_wall_layout *l, __global ushort16 *lines, uint line_vectors, uint y) {
    const uint vectors = padded_width_of(l) / SV_LANES, ring = (2 * l->mean[2] + 1) * vectors;
    lines += (size_t)y * line_vectors;
    for (uint i = 0; i < line_vectors; i++) lines[i] = (ushort16)(0);
    row_t r;
    r.ring = lines;
    r.sums = lines + ring;
    r.columns = (__global ushort *)(lines + ring + 2 * vectors);
    r.means = (__global uchar *)(r.columns + 2 * WORD_MARGIN + vectors * SV_LANES);
    return r;
}

/* Scanned rays of a row. */
static uint count_rays(const sv_wall_layout *l, __global ushort16 *rays, uint y) {
    __global const ushort *first = (__global const ushort *)ray_row(rays, l, RAY_FIRST, y);
    __global const ushort *end = (__global const ushort *)ray_row(rays, l, RAY_END, y);
    uint count = 0;
    for (uint x = 0; x < l->width; x++) count += end[x] > first[x];
    return count;
}

/* One work item per row. `lines`: line_vectors a row. `beside`: the largest means of a row beside every ray.
 */
__kernel void wall_means(sv_wall_layout l, uint line_vectors, __global const uchar16 *restrict voxels,
                         __global ushort16 *restrict rays, __global ushort16 *restrict lines,
                         __global uchar *restrict beside, __global uint *restrict histograms) {
    const uint y = (uint)get_global_id(0), vectors = padded_width_of(&l) / SV_LANES, rz = l.mean[2];
    const divider_t divider = divider_of(&l);
    const row_t r = row_of(&l, lines, line_vectors, y);
    const uchar16 last = pixels_of((vectors - 1) * SV_LANES, l.width);
    __global const ushort16 *first = ray_row(rays, &l, RAY_BOX_FIRST, y);
    __global const ushort16 *end = ray_row(rays, &l, RAY_BOX_END, y);
    __global uchar16 *means = (__global uchar16 *)(r.means + BYTE_MARGIN);
    uint histogram[4][256];
    for (uint i = 0; i < 256; i++) histogram[0][i] = histogram[1][i] = histogram[2][i] = histogram[3][i] = 0;
    find_boxes(&l, rays, y);
    for (uint next = 0; next < l.slices + rz; next++) {
        __global ushort16 *line = r.ring + next % (2 * rz + 1) * vectors;
        if (next < l.slices) sum_rows_of(&l, voxels, next, y, &r);
        const ushort z = (ushort)(next - min(next, rz));
        for (uint x = 0; x < vectors; x++) {
            const ushort16 less = line[x],
                           more = next < l.slices ? sum_columns(&r, x, l.mean[0]) : (ushort16)(0);
            line[x] = more;
            uchar16 mean = mean_of(&divider, r.sums, x, vectors, more, less);
            if (next < rz) continue;
            count(histogram, mean, (first[x] <= z) & (end[x] > z));
            if (x + 1 == vectors) mean &= last;
            means[x] = mean;
        }
        if (next >= rz)
            largest_of_row(&l, r.means + BYTE_MARGIN, l.beside[0], l.beside[0], 1,
                           beside + ((size_t)z * l.height + y) * padded_width_of(&l));
    }
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
        largest_of_row(&l, beside + row, min(reach, y), min(reach, l.height - 1 - y), (int)width,
                       bright + row);
    }
}
