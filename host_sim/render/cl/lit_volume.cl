/* SPDX-License-Identifier: MIT */
/*
 * What the lit look draws (host_sim/render/lit_volume.h): the volume halved (cl/halve.cl; if large), then
 * smoothed, and a coarse grid of opacities for light. The smoothing has the weights 1, 2, 1 along every axis
 * and rounds to the nearest level, halves up. LIT_PAD voxels of 0 surround the volume, so that its own faces
 * are edges like any other and nothing is ever read outside.
 *
 * CPU: a work item makes a row; global (1, y or more, z). GPU: a work item makes a voxel; global (x, y, z).
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

#define SMOOTH_AT(rows, i) (((rows)[(i)-1] + 2 * (rows)[i] + (rows)[(i) + 1] + 32) >> 6)

#if LANES == 16
#define MAX_HALF 1028 /* half of MAX_ROW, and the padding */

/* Sums of 3 x 3 rows with the weights of y and z. */
INLINE ushort16 weigh_rows(__global const uchar *at, size_t row, size_t slice) {
    ushort16 sum = 0;
    for (int z = -1; z <= 1; z++) {
        __global const uchar *p = at + z * (long)slice;
        ushort16 line = convert_ushort16(vload16(0, p - row)) + convert_ushort16(vload16(0, p + row)) +
                        convert_ushort16(vload16(0, p)) * (ushort)2;
        sum += z == 0 ? line * (ushort)2 : line;
    }
    return sum;
}

INLINE ushort weigh_row(__global const uchar *at, size_t row, size_t slice) {
    ushort sum = 0;
    for (int z = -1; z <= 1; z++) {
        __global const uchar *p = at + z * (long)slice;
        ushort line = (ushort)(*(p - row) + *(p + row) + 2 * *p);
        sum += z == 0 ? 2 * line : line;
    }
    return sum;
}

WIDE __kernel void lit_smooth(__global const uchar *half_size, int4 dims, __global uchar *out) {
    int y = (int)get_global_id(1), z = (int)get_global_id(2);
    if (y >= dims.y) return;
    size_t row = dims.x, slice = (size_t)dims.x * dims.y, begin = (size_t)z * slice + (size_t)y * row;
    if (y == 0 || z == 0 || y == dims.y - 1 || z == dims.z - 1) {
        for (int x = 0; x < dims.x; x++) out[begin + x] = 0;
        return;
    }
    ushort sums[MAX_HALF + 16];
    int x = 0;
    for (; x + 16 <= dims.x; x += 16) STORE(weigh_rows(half_size + begin + x, row, slice), sums + x);
    for (; x < dims.x; x++) sums[x] = weigh_row(half_size + begin + x, row, slice);
    out[begin] = out[begin + dims.x - 1] = 0;
    for (x = 1; x + 16 < dims.x; x += 16) {
        ushort16 sum = vload16(0, sums + x - 1) + vload16(0, sums + x) * (ushort)2 + vload16(0, sums + x + 1);
        store_bytes(convert_uchar16((sum + (ushort)32) >> (ushort)6), out + begin + x);
    }
    for (; x < dims.x - 1; x++) out[begin + x] = (uchar)SMOOTH_AT(sums, x);
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
/* A row of cells: sums down the columns first, then along the row. */
WIDE __kernel void lit_opacity(__global const uchar *smooth, int4 dims, int4 cells, float4 window,
                               __global uchar *out) {
    int y = (int)get_global_id(1), z = (int)get_global_id(2), block = cells.w;
    if (y >= cells.y) return;
    int y1 = min((y + 1) * block, dims.y), z1 = min((z + 1) * block, dims.z);
    float sums[MAX_HALF + 16];
    for (int x = 0; x < dims.x; x += 16) STORE((float16)(0.0f), sums + x);
    for (int k = z * block; k < z1; k++)
        for (int j = y * block; j < y1; j++) {
            __global const uchar *row = smooth + ((size_t)k * dims.y + j) * dims.x;
            int x = 0;
            for (; x + 16 <= dims.x; x += 16) {
                float16 value = (convert_float16(vload16(0, row + x)) - window.x) * window.y;
                STORE(vload16(0, sums + x) + clamp(value, 0.0f, 1.0f), sums + x);
            }
            for (; x < dims.x; x++) sums[x] += clamp(((float)row[x] - window.x) * window.y, 0.0f, 1.0f);
        }
    float scale = 255.0f / (float)(block * block * block);
    for (int x = 0; x < cells.x; x++) {
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
