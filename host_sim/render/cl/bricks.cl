/* SPDX-License-Identifier: MIT */
/*
 * The grid of brick maxima: what the renderer may skip. A trilinear sample with its lower corner at voxel i
 * reads i and i + 1, so bricks overlap by one voxel in every axis:
 *
 *     voxels    0 1 2 3 4 5 6 7 8 9 ...
 *
 *     brick 0   [---------------]
 *
 *     brick 1                   [------
 *
 * The volume is read once, nearly in the order in which it lies in memory.
 */
#define BRICK_EDGE (1 << BRICK_SHIFT)

#if LANES == 16
#define MAX_ROW 2048 /* voxels; the host's limit for a volume's axis */
#define CHUNK   64   /* columns folded in registers at a time */

/* The rows of a brick's cross-section, first .. last in y and z. */
typedef struct {
    int y0, y1, z0, z1;
} section;

/* The maximum of every column of `section` from x on. */
INLINE void fold_chunk(__global const uchar *voxels, int4 dims, section s, int x, uchar *columns) {
    uchar16 a = 0, b = 0, c = 0, d = 0;
    for (int z = s.z0; z <= s.z1; z++) {
        __global const uchar *row = voxels + ((size_t)z * dims.y + s.y0) * dims.x + x;
        for (int y = s.y0; y <= s.y1; y++, row += dims.x) {
            a = max(a, LOAD(row));
            b = max(b, LOAD(row + 16));
            c = max(c, LOAD(row + 32));
            d = max(d, LOAD(row + 48));
        }
    }
    STORE(a, columns + x + 16 * 0);
    STORE(b, columns + x + 16 * 1);
    STORE(c, columns + x + 16 * 2);
    STORE(d, columns + x + 16 * 3);
}

INLINE void fold_column(__global const uchar *voxels, int4 dims, section s, int x, uchar *columns) {
    uchar largest = 0;
    for (int z = s.z0; z <= s.z1; z++) {
        for (int y = s.y0; y <= s.y1; y++) {
            largest = max(largest, voxels[((size_t)z * dims.y + y) * dims.x + x]);
        }
    }
    columns[x] = largest;
}

/* global: (1, bricks.y or more, bricks.z); a work item makes one row of bricks. */
__kernel void build_brick_grid(__global const uchar *voxels, int4 dims, int4 bricks, __global uchar *grid) {
    int by = (int)get_global_id(1), bz = (int)get_global_id(2);
    if (by >= bricks.y) return;
    section s = {by << BRICK_SHIFT, 0, bz << BRICK_SHIFT, 0};
    s.y1 = min(s.y0 + BRICK_EDGE, dims.y - 1);
    s.z1 = min(s.z0 + BRICK_EDGE, dims.z - 1);
    uchar columns[MAX_ROW + BRICK_EDGE + 1];
    int x = 0;
    for (; x + CHUNK <= dims.x; x += CHUNK) fold_chunk(voxels, dims, s, x, columns);
    if (x < dims.x && dims.x >= CHUNK) {
        fold_chunk(voxels, dims, s, dims.x - CHUNK, columns); /* the rest, and some columns again */
    } else {
        for (; x < dims.x; x++) fold_column(voxels, dims, s, x, columns);
    }
    for (int i = 0; i <= BRICK_EDGE; i++) columns[dims.x + i] = 0;
    __global uchar *out = grid + (bz * bricks.y + by) * bricks.x;
    for (int bx = 0; bx < bricks.x; bx++) {
        uchar *first = columns + (bx << BRICK_SHIFT);
        uchar largest = first[BRICK_EDGE];
        for (int i = 0; i < BRICK_EDGE; i++) largest = max(largest, first[i]);
        out[bx] = largest;
    }
}
#else
/* global: bricks; a work item makes one brick. */
__kernel void build_brick_grid(__global const uchar *voxels, int4 dims, int4 bricks, __global uchar *grid) {
    int bx = (int)get_global_id(0), by = (int)get_global_id(1), bz = (int)get_global_id(2);
    int x0 = bx << BRICK_SHIFT, y0 = by << BRICK_SHIFT, z0 = bz << BRICK_SHIFT;
    int x1 = min(x0 + BRICK_EDGE, dims.x - 1);
    int y1 = min(y0 + BRICK_EDGE, dims.y - 1), z1 = min(z0 + BRICK_EDGE, dims.z - 1);
    uchar largest = 0;
    for (int z = z0; z <= z1; z++) {
        for (int y = y0; y <= y1; y++) {
            const __global uchar *row = voxels + ((size_t)z * dims.y + y) * dims.x;
            for (int x = x0; x <= x1; x++) largest = max(largest, row[x]);
        }
    }
    grid[(bz * bricks.y + by) * bricks.x + bx] = largest;
}
#endif
