/* SPDX-License-Identifier: MIT */
/*
 * A volume at half its resolution (host_sim/render/derived_volume.h defines both results), made in one pass
 * over its bytes: the mean of 2 x 2 x 2 voxels for light, and for scan conversion the same with marks where
 * not all of them were scanned.
 *
 * dims: source voxels; half_dims: halved ones, w: the empty border around `mean`, or -1: there is no `mean`.
 * CPU: a work item makes a slice; global (1, 1, z). GPU: a work item makes a voxel; global (x, y, z).
 */

#define HALVED_PARTLY 1 /* some of the eight were scanned */
#define HALVED_MIN    2 /* the least mean of eight that all were */

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

/* The mean of the eight voxels at x, and it again with marks. */
INLINE uchar2 halved(four_rows r, int count, int x) {
    int x1 = min(x + 1, count - 1), scanned = 0;
    uint sum = 4;
    for (int i = 0; i < 4; i++) {
        uchar a = r.row[i][x], b = r.row[i][x1];
        sum += (uint)a + b;
        scanned += (a > 0) + (b > 0);
    }
    uchar mean = (uchar)(sum >> 3);
    uchar marked = scanned == 8 ? max(mean, (uchar)(HALVED_MIN)) : (uchar)(scanned ? HALVED_PARTLY : 0);
    return (uchar2)(mean, marked);
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

/* Returns all ones for every pair of bytes that has a 0. */
INLINE ushort16 zero_in_pair(ushort16 pairs) {
    ushort16 zero = (pairs - (ushort16)(0x0101)) & ~pairs & (ushort16)(0x8080);
    return as_ushort16(zero != (ushort16)(0));
}

#define AHEAD 2048 /* bytes: a few hundred nanoseconds' reading */

/* The means of 16 x 8 voxels from x on, and they again with marks. */
INLINE void halve_sixteen(four_rows r, int x, __global uchar *all, __global uchar *marked) {
    uchar16 min_a = (uchar16)(255), min_b = (uchar16)(255), max_a = (uchar16)(0), max_b = max_a;
    ushort16 sum = (ushort16)(4);
    for (int i = 0; i < 4; i++) {
        uchar16 a = LOAD(r.row[i] + x), b = LOAD(r.row[i] + x + 16);
        fetch_ahead(r.row[i] + x, AHEAD);
        min_a = min(min_a, a);
        min_b = min(min_b, b);
        max_a = max(max_a, a);
        max_b = max(max_b, b);
        sum += pair_sums(sixteen_pairs(a, b));
    }
    sum >>= (ushort16)(3);
    store_bytes(convert_uchar16(sum), all + x / 2);
    ushort16 part = zero_in_pair(sixteen_pairs(min_a, min_b));
    ushort16 some = as_ushort16(sixteen_pairs(max_a, max_b) != (ushort16)(0));
    sum = (max(sum, (ushort16)(HALVED_MIN)) & ~part) | ((ushort16)(HALVED_PARTLY)&part & some);
    store_bytes(convert_uchar16(sum), marked + x / 2);
}

/* One work item a slice: the global size is (1, 1, slices). */
WIDE __kernel void halve_volume(__global const uchar *voxels, int4 dims, int4 half_dims, __global uchar *mean,
                                __global uchar *marked) {
    int z = (int)get_global_id(2), even = dims.x & ~1;
    for (int y = 0; y < half_dims.y; y++) {
        four_rows r = rows_below(voxels, dims, 2 * y, 2 * z);
        __global uchar *to = marked + ((size_t)z * half_dims.y + y) * half_dims.x;
        __global uchar *all = half_dims.w < 0 ? to : mean + mean_row(half_dims, y, z);
        int x = 0;
        for (; x + 32 <= even; x += 32) halve_sixteen(r, x, all, to);
        if (x > 0 && x < even) {
            halve_sixteen(r, even - 32, all, to); /* the rest, and some again */
            x = even;
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
                           __global uchar *marked) {
    int x = (int)get_global_id(0), y = (int)get_global_id(1), z = (int)get_global_id(2);
    uchar2 both = halved(rows_below(voxels, dims, 2 * y, 2 * z), dims.x, 2 * x);
    if (half_dims.w >= 0) mean[mean_row(half_dims, y, z) + x] = both.x;
    marked[((size_t)z * half_dims.y + y) * half_dims.x + x] = both.y;
}
#endif
