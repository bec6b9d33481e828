/* SPDX-License-Identifier: MIT */
/*
 * What the lit look draws (host_sim/render/derived_volume.h): the volume halved (cl/halve.cl; if large), then
 * smoothed, and a coarse grid of opacities for light. The smoothing has the weights 1, 2, 1 along every axis
 * and rounds to the nearest level, halves up. LIT_PAD voxels of 0 surround the volume, so that its own faces
 * are edges like any other and nothing is ever read outside.
 *
 * CPU: a work item makes a row, global (1, y or more, z), or a slice. GPU: a work item makes a voxel; global
 * (x, y, z).
 */

/* A small volume is not halved: it has no voxel to spare. */
__kernel void lit_keep(__global const uchar *voxels, int4 dims, int4 out_dims, __global uchar *out) {
    int y = (int)get_global_id(1), z = (int)get_global_id(2), sy = y - LIT_PAD, sz = z - LIT_PAD;
    if (y >= out_dims.y) return;
    bool inside = min(sy, sz) >= 0 && sy < dims.y && sz < dims.z;
    for (int x = (int)get_global_id(0); x < out_dims.x; x += (int)get_global_size(0)) {
        int sx = x - LIT_PAD;
        uchar value = 0;
        if (inside && sx >= 0 && sx < dims.x) value = voxels[((size_t)sz * dims.y + sy) * dims.x + sx];
        out[((size_t)z * out_dims.y + y) * out_dims.x + x] = value;
    }
}

#if LANES == 16
#define MAX_HALF 1028 /* half of MAX_ROW, and the padding */

/* Three rows weighted 1, 2, 1, from x on. */
INLINE ushort16 weigh_sixteen(__global const uchar *a, __global const uchar *b, __global const uchar *c) {
    return convert_ushort16(LOAD(a)) + (convert_ushort16(LOAD(b)) << (ushort16)(1)) +
           convert_ushort16(LOAD(c));
}

/* Row `at` of three slices. */
INLINE void weigh_slices(__global const uchar *at, size_t slice, int count, ushort *sums) {
    __global const uchar *before = at - slice, *behind = at + slice;
    int x = 0;
    for (; x + 16 <= count; x += 16) STORE(weigh_sixteen(before + x, at + x, behind + x), sums + x);
    if (x > 0 && x < count) {
        x = count - 16; /* the rest, and some again */
        STORE(weigh_sixteen(before + x, at + x, behind + x), sums + x);
        return;
    }
    for (; x < count; x++) sums[x] = (ushort)(before[x] + 2 * at[x] + behind[x]);
}

/* A row of the result but for its ends, from three such rows. */
INLINE void weigh_rows(const ushort *above, const ushort *at, const ushort *below, int count,
                       __global uchar *out) {
    ushort sums[MAX_HALF + 16];
    for (int x = 0; x < count; x += 16)
        STORE(LOAD(above + x) + (LOAD(at + x) << (ushort16)(1)) + LOAD(below + x), sums + x);
    for (int x = 1; x < count - 1; x += 16) {
        if (x > 1 && x + 16 >= count) x = count - 17;
        ushort16 sum = LOAD(sums + x - 1) + (LOAD(sums + x) << (ushort16)(1)) + LOAD(sums + x + 1);
        uchar16 mean = convert_uchar16((sum + (ushort)32) >> (ushort16)(6));
        if (x + 16 < count) {
            store_bytes(mean, out + x);
            continue;
        }
        uchar few[LANES];
        STORE(mean, few);
        for (int i = 0; x + i < count - 1; i++) out[x + i] = few[i];
    }
}

#define ROWS_AHEAD 8

/* Asks for the rows that are read and written next. */
INLINE void ask_ahead(__global const uchar *from, __global const uchar *to, int count) {
    for (int x = 0; x < count; x += 64) {
        fetch_ahead(from + x, ROWS_AHEAD * count);
        fetch_ahead(to + x, ROWS_AHEAD * count);
    }
}

INLINE void clear_row(__global uchar *row, int count) {
    for (int x = 0; x < count; x++) row[x] = 0;
}

/* global: (1, 1, slices). The sums of three slices are made once for every row. */
WIDE __kernel void lit_smooth(__global const uchar *half_size, int4 dims, __global uchar *out) {
    int z = (int)get_global_id(2);
    size_t row = dims.x, slice = (size_t)dims.x * dims.y;
    __global const uchar *from = half_size + z * slice;
    __global uchar *to = out + z * slice;
    ushort sums[3][MAX_HALF + 16];
    if (z == 0 || z == dims.z - 1) {
        clear_row(to, (int)slice);
        return;
    }
    clear_row(to, dims.x);
    clear_row(to + (dims.y - 1) * row, dims.x);
    weigh_slices(from, slice, dims.x, sums[0]);
    weigh_slices(from + row, slice, dims.x, sums[1]);
    for (int y = 1; y < dims.y - 1; y++) {
        ask_ahead(from + y * row + slice, to + y * row, dims.x);
        weigh_slices(from + (y + 1) * row, slice, dims.x, sums[(y + 1) % 3]);
        weigh_rows(sums[(y - 1) % 3], sums[y % 3], sums[(y + 1) % 3], dims.x, to + y * row);
        to[y * row] = to[y * row + dims.x - 1] = 0;
    }
}
#else
__kernel void lit_smooth(__global const uchar *half_size, int4 dims, __global uchar *out) {
    int x = (int)get_global_id(0), y = (int)get_global_id(1), z = (int)get_global_id(2);
    size_t at = ((size_t)z * dims.y + y) * dims.x + x;
    if (min(x, min(y, z)) == 0 || x == dims.x - 1 || y == dims.y - 1 || z == dims.z - 1) {
        out[at] = 0;
        return;
    }
    uint sum = 32;
    for (int dz = -1; dz <= 1; dz++)
        for (int dy = -1; dy <= 1; dy++)
            for (int dx = -1; dx <= 1; dx++)
                sum += (uint)half_size[at + (dz * (long)dims.y + dy) * dims.x + dx] * (uint)(2 - abs(dx)) *
                       (uint)(2 - abs(dy)) * (uint)(2 - abs(dz));
    out[at] = (uchar)(sum >> 6);
}
#endif

/*
 * The mean opacity of blocks of `block` smoothed voxels an edge, 0 .. 255; what stands out of the volume is
 * 0. window: x T_L * 255, y 1 / ((T_H - T_L) * 255). cells.w: block.
 */
#if LANES == 16
/* Sums of opacities down a cell's section, in columns x to x + 15. */
INLINE float16 sum_columns(__global const uchar *from, int4 dims, int rows, int slices, float4 window) {
    float16 sum = (float16)(0.0f);
    for (int k = 0; k < slices; k++)
        for (int j = 0; j < rows; j++) {
            __global const uchar *at = from + ((size_t)k * dims.y + j) * dims.x;
            sum += clamp((convert_float16(LOAD(at)) - window.x) * window.y, 0.0f, 1.0f);
        }
    return sum;
}

INLINE float sum_column(__global const uchar *from, int4 dims, int rows, int slices, float4 window) {
    float sum = 0.0f;
    for (int k = 0; k < slices; k++)
        for (int j = 0; j < rows; j++)
            sum += clamp(((float)from[((size_t)k * dims.y + j) * dims.x] - window.x) * window.y, 0.0f, 1.0f);
    return sum;
}

/* A row of cells: sums down the columns first, then along the row. */
WIDE __kernel void lit_opacity(__global const uchar *smooth, int4 dims, int4 cells, float4 window,
                               __global uchar *out) {
    int y = (int)get_global_id(1), z = (int)get_global_id(2), block = cells.w;
    if (y >= cells.y) return;
    int rows = min(block, dims.y - y * block), slices = min(block, dims.z - z * block), x = 0;
    __global const uchar *from = smooth + ((size_t)z * block * dims.y + y * block) * dims.x;
    float sums[MAX_HALF + 16];
    for (; x + 16 <= dims.x; x += 16) STORE(sum_columns(from + x, dims, rows, slices, window), sums + x);
    if (x > 0 && x < dims.x) {
        x = dims.x - 16; /* the rest, and some again */
        STORE(sum_columns(from + x, dims, rows, slices, window), sums + x);
    } else {
        for (; x < dims.x; x++) sums[x] = sum_column(from + x, dims, rows, slices, window);
    }
    float scale = 255.0f / (float)(block * block * block);
    for (x = 0; x < cells.x; x++) {
        float sum = 0.0f;
        for (int i = x * block; i < min((x + 1) * block, dims.x); i++) sum += sums[i];
        out[(z * cells.y + y) * cells.x + x] = convert_uchar_sat_rte(scale * sum);
    }
}
#else
__kernel void lit_opacity(__global const uchar *smooth, int4 dims, int4 cells, float4 window,
                          __global uchar *out) {
    int x = (int)get_global_id(0), y = (int)get_global_id(1), z = (int)get_global_id(2), block = cells.w;
    int x1 = min((x + 1) * block, dims.x);
    int y1 = min((y + 1) * block, dims.y), z1 = min((z + 1) * block, dims.z);
    float sum = 0.0f;
    for (int k = z * block; k < z1; k++)
        for (int j = y * block; j < y1; j++) {
            __global const uchar *row = smooth + ((size_t)k * dims.y + j) * dims.x;
            for (int i = x * block; i < x1; i++)
                sum += clamp(((float)row[i] - window.x) * window.y, 0.0f, 1.0f);
        }
    out[(z * cells.y + y) * cells.x + x] =
        convert_uchar_sat_rte(255.0f / (float)(block * block * block) * sum);
}
#endif

/*
 * The share of cubes of voxels that was scanned (host_sim/render/derived_volume.h), 0 .. 255, halves up;
 * smoothed by lit_smooth (cl/lit_volume.cl) then. SHARE_PAD cubes of 0 surround it.
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
