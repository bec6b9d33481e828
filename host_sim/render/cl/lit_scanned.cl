/* SPDX-License-Identifier: MIT */
/*
 * The share of cubes of voxels that was scanned (host_sim/render/scan_share.h), 0 .. 255, halves up; smoothed
 * by lit_smooth (cl/lit_volume.cl) then. SHARE_PAD cubes of 0 surround it.
 *
 * marks: voxels, or the halved volume's marks. dims: theirs, w: the mark from which on all of one was scanned
 * (one less is a half, or nothing). shares: cubes, w: voxels along an edge.
 * CPU: a work item makes a row; global (1, y or more, z). GPU: a work item makes a cube; global (x, y, z).
 */

INLINE uchar share_of(uint sum, int4 dims, int4 shares) {
    uint all = (uint)(dims.w * shares.w * shares.w * shares.w);
    return (uchar)((510 * sum + all) / (2 * all));
}

#if LANES == 16
#define MAX_MARKS 1024 /* half of MAX_ROW */

/* Sums of marks down a cube's section, in columns x to x + 15. */
INLINE ushort16 sum_marks(__global const uchar *from, int4 dims, int rows, int slices) {
    ushort16 sum = (ushort16)(0);
    for (int k = 0; k < slices; k++)
        for (int j = 0; j < rows; j++)
            sum += convert_ushort16(
                min(LOAD(from + ((size_t)k * dims.y + j) * dims.x), (uchar16)((uchar)dims.w)));
    return sum;
}

INLINE ushort sum_mark(__global const uchar *from, int4 dims, int rows, int slices) {
    ushort sum = 0;
    for (int k = 0; k < slices; k++)
        for (int j = 0; j < rows; j++)
            sum += (ushort)min((int)from[((size_t)k * dims.y + j) * dims.x], dims.w);
    return sum;
}

WIDE __kernel void lit_scanned(__global const uchar *marks, int4 dims, int4 shares, __global uchar *out) {
    int y = (int)get_global_id(1), z = (int)get_global_id(2), edge = shares.w;
    if (y >= shares.y) return;
    __global uchar *row = out + ((size_t)z * shares.y + y) * shares.x;
    int y0 = max((y - SHARE_PAD) * edge, 0), rows = min((y - SHARE_PAD + 1) * edge, dims.y) - y0;
    int z0 = max((z - SHARE_PAD) * edge, 0), slices = min((z - SHARE_PAD + 1) * edge, dims.z) - z0, x = 0;
    __global const uchar *from = marks + ((size_t)z0 * dims.y + y0) * dims.x;
    ushort sums[MAX_MARKS + 16];
    if (rows <= 0 || slices <= 0) { /* a border */
        for (; x < shares.x; x++) row[x] = 0;
        return;
    }
    for (; x + 16 <= dims.x; x += 16) STORE(sum_marks(from + x, dims, rows, slices), sums + x);
    if (x > 0 && x < dims.x) {
        x = dims.x - 16; /* the rest, and some again */
        STORE(sum_marks(from + x, dims, rows, slices), sums + x);
    } else {
        for (; x < dims.x; x++) sums[x] = sum_mark(from + x, dims, rows, slices);
    }
    for (x = 0; x < shares.x; x++) {
        int x0 = (x - SHARE_PAD) * edge;
        uint sum = 0;
        for (int i = max(x0, 0); i < min(x0 + edge, dims.x); i++) sum += sums[i];
        row[x] = share_of(sum, dims, shares);
    }
}
#else
__kernel void lit_scanned(__global const uchar *marks, int4 dims, int4 shares, __global uchar *out) {
    int x = (int)get_global_id(0), y = (int)get_global_id(1), z = (int)get_global_id(2), edge = shares.w;
    int x0 = (x - SHARE_PAD) * edge, y0 = (y - SHARE_PAD) * edge, z0 = (z - SHARE_PAD) * edge;
    uint sum = 0;
    for (int k = max(z0, 0); k < min(z0 + edge, dims.z); k++)
        for (int j = max(y0, 0); j < min(y0 + edge, dims.y); j++) {
            __global const uchar *row = marks + ((size_t)k * dims.y + j) * dims.x;
            for (int i = max(x0, 0); i < min(x0 + edge, dims.x); i++) sum += (uint)min((int)row[i], dims.w);
        }
    out[((size_t)z * shares.y + y) * shares.x + x] = share_of(sum, dims, shares);
}
#endif
