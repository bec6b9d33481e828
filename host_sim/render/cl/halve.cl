/* SPDX-License-Identifier: MIT */
/*
 * A volume at half its resolution (host_sim/render/halved.h defines both results), made in one pass over its
 * bytes: the mean of 2 x 2 x 2 voxels for light, and the mean of those of them that were scanned for scan
 * conversion. Both round to the nearest level, halves up.
 *
 * dims: source voxels; half_dims: halved ones, w: the empty border around `mean`, or -1: there is no `mean`.
 * CPU: a work item makes a slice; global (1, 1, z). GPU: a work item makes a voxel; global (x, y, z).
 */

/* Where 2 x 2 rows of the source begin; the last one stands twice where an axis is odd. */
typedef struct {
    __global const uchar *row[4];
} four_rows;

INLINE four_rows rows_below(__global const uchar *voxels, int4 dims, int y, int z) {
    int y1 = min(y + 1, dims.y - 1), z1 = min(z + 1, dims.z - 1);
    four_rows r;
    r.row[0] = voxels + ((size_t)z * dims.y + y) * dims.x;
    r.row[1] = voxels + ((size_t)z * dims.y + y1) * dims.x;
    r.row[2] = voxels + ((size_t)z1 * dims.y + y) * dims.x;
    r.row[3] = voxels + ((size_t)z1 * dims.y + y1) * dims.x;
    return r;
}

/* Both means of the eight voxels at x: of all, and of the scanned ones if these are half of them or more. */
INLINE uchar2 halved(four_rows r, int count, int x) {
    int x1 = min(x + 1, count - 1);
    uint sum = 0, scanned = 0;
    for (int i = 0; i < 4; i++) {
        uint a = r.row[i][x], b = r.row[i][x1];
        sum += a + b;
        scanned += (a > 0) + (b > 0);
    }
    uint mean = scanned < 4 ? 0 : (2 * sum + scanned) / (2 * scanned);
    return (uchar2)((uchar)((sum + 4) >> 3), (uchar)mean);
}

/* Where row (y, z) of `mean` begins. */
INLINE size_t mean_row(int4 half_dims, int y, int z) {
    size_t row = half_dims.x + 2 * half_dims.w, rows = half_dims.y + 2 * half_dims.w;
    return ((z + half_dims.w) * rows + y + half_dims.w) * row + half_dims.w;
}

#if LANES == 16
/* 32 voxels of a row, as 16 pairs of neighbours; which of a pair comes first does not matter. */
INLINE ushort16 sixteen_pairs(uchar16 a, uchar16 b) {
    return (ushort16)(as_ushort8(a), as_ushort8(b));
}

INLINE ushort16 pair_sums(ushort16 pairs) {
    return (pairs & (ushort16)(0xff)) + (pairs >> (ushort16)(8));
}

/* The mean of the scanned voxels where not all are. */
INLINE uchar16 scanned_means(ushort16 sum, ushort16 count) {
    int16 n = convert_int16(count);
    return convert_uchar16(select(rounded_mean(convert_int16(sum), max(n, 1)), (int16)(0), n < 4));
}

INLINE bool any_zero(uchar16 v) {
    ulong2 zero = as_ulong2(v == (uchar16)(0));
    return (zero.x | zero.y) != 0;
}

/* global: (1, 1, slices). */
WIDE __kernel void halve_volume(__global const uchar *voxels, int4 dims, int4 half_dims, __global uchar *mean,
                                __global uchar *scanned) {
    int z = (int)get_global_id(2);
    for (int y = 0; y < half_dims.y; y++) {
        four_rows r = rows_below(voxels, dims, 2 * y, 2 * z);
        __global uchar *to = scanned + ((size_t)z * half_dims.y + y) * half_dims.x;
        __global uchar *all = half_dims.w < 0 ? to : mean + mean_row(half_dims, y, z);
        int x = 0;
        for (; x + 32 <= dims.x; x += 32) {
            uchar16 least = (uchar16)(255);
            ushort16 sum = (ushort16)(0), number = (ushort16)(0);
            for (int i = 0; i < 4; i++) {
                uchar16 a = vload16(0, r.row[i] + x), b = vload16(1, r.row[i] + x);
                least = min(least, min(a, b));
                sum += pair_sums(sixteen_pairs(a, b));
            }
            uchar16 whole = convert_uchar16((sum + (ushort16)(4)) >> (ushort16)(3));
            store_bytes(whole, all + x / 2);
            if (any_zero(least)) {
                for (int i = 0; i < 4; i++) {
                    uchar16 a = vload16(0, r.row[i] + x), b = vload16(1, r.row[i] + x);
                    number += pair_sums(sixteen_pairs(min(a, (uchar16)(1)), min(b, (uchar16)(1))));
                }
                whole = scanned_means(sum, number);
            }
            store_bytes(whole, to + x / 2);
        }
        for (; x < dims.x; x += 2) {
            uchar2 both = halved(r, dims.x, x);
            all[x / 2] = both.x;
            to[x / 2] = both.y;
        }
    }
}
#else
__kernel void halve_volume(__global const uchar *voxels, int4 dims, int4 half_dims, __global uchar *mean,
                           __global uchar *scanned) {
    int x = (int)get_global_id(0), y = (int)get_global_id(1), z = (int)get_global_id(2);
    uchar2 both = halved(rows_below(voxels, dims, 2 * y, 2 * z), dims.x, 2 * x);
    if (half_dims.w >= 0) mean[mean_row(half_dims, y, z) + x] = both.x;
    scanned[((size_t)z * half_dims.y + y) * half_dims.x + x] = both.y;
}
#endif
