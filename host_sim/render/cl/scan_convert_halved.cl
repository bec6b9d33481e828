/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion from the halved volume (cl/halve.cl): trilinear samples in integers, so that every device
 * makes the same bytes (host_sim/render/scan_convert.h defines the result). A halved voxel is a mean of
 * eight, so one sample does what some twenty would do in the source, from an eighth of the bytes. At the
 * edge of what was scanned the nearest voxels of the source count, as in convert_nearest.
 */
#define WEIGHT_BITS 8 /* of a position between two voxels: a sample's weights add up to 1 << 8 */

/* Two neighbours in x and the two at y + 1, as the lower and the upper half of a word. */
#if LANES == 16
typedef uint16 vu;
#define TO_VU(v) convert_uint16(v)
#define AS_VU(v) as_uint16(v)
#else
typedef uint vu;
#define TO_VU(v) convert_uint(v)
#define AS_VU(v) as_uint(v)
#endif
#define SQUARES(p, row, i) (TO_VU(PAIRS(p, i)) | TO_VU(PAIRS((p) + (row), i)) << 16)

/* The eight voxels around a packet's positions, and where between them: 0 .. 1 << WEIGHT_BITS. */
typedef struct {
    vu near, far; /* slices z and z + 1 */
    vi fx, fy, fz;
} fixed_cell;

/* A position's lower voxel and its fraction; in the outer half voxel those of the nearest one. */
INLINE vi split_fixed(vi position, int count, int bits, vi *fraction) {
    vi p = clamp(position, (vi)(0), (vi)((count - 1) << bits)) + (1 << (bits - WEIGHT_BITS - 1));
    vi i = min(p >> bits, (vi)(max(count - 2, 0)));
    *fraction = (p - (i << bits)) >> (bits - WEIGHT_BITS);
    return i;
}

INLINE fixed_cell fetch_fixed(__global const uchar *halved, int4 dims, vi x, vi y, vi z, int bits) {
    fixed_cell c;
    vi ix = split_fixed(x, dims.x, bits, &c.fx);
    vi iy = split_fixed(y, dims.y, bits, &c.fy);
    vi iz = split_fixed(z, dims.z, bits, &c.fz);
    vi i = (iz * dims.y + iy) * dims.x + ix;
    /* An axis with a single voxel has no second neighbour; its fraction is 0. */
    int row = dims.y > 1 ? dims.x : 0, slice = dims.z > 1 ? dims.x * dims.y : 0;
    c.near = SQUARES(halved, row, i);
    c.far = SQUARES(halved + slice, row, i);
    return c;
}

#define EVEN_BYTES 0x00ff00ffu

/* The mean of a square, times 1 << WEIGHT_BITS: along both rows at once, then between them. */
INLINE vi mix_square(vu square, vi fx, vi fy) {
#ifdef __ENDIAN_LITTLE__
    vu first = square & EVEN_BYTES, second = (square >> 8) & EVEN_BYTES;
#else
    vu second = square & EVEN_BYTES, first = (square >> 8) & EVEN_BYTES;
#endif
    vu rows = (first << WEIGHT_BITS) - first * AS_VU(fx) + second * AS_VU(fx);
    vu upper = rows & 0xffffu, lower = rows >> 16;
    vu both = (upper << WEIGHT_BITS) - upper * AS_VU(fy) + lower * AS_VU(fy);
    return TO_VI((both + (1u << (WEIGHT_BITS - 1))) >> WEIGHT_BITS);
}

/* The trilinear mean of the eight voxels, times 1 << WEIGHT_BITS. */
INLINE vi blend_fixed(fixed_cell c) {
    vi a = mix_square(c.near, c.fx, c.fy), b = mix_square(c.far, c.fx, c.fy);
    return ((a << WEIGHT_BITS) + (b - a) * c.fz + (1 << (WEIGHT_BITS - 1))) >> WEIGHT_BITS;
}

/* What a packet's samples come to: their sum, times 1 << WEIGHT_BITS; -1 in lanes all of whose samples lie
 * between whole voxels, or in those none of whose samples lies beside anything scanned. */
typedef struct {
    vi sum, whole, empty;
} fixed_sum;

INLINE fixed_sum gather_halved(__global const uchar *halved, int4 dims, int4 limit, int4 grid, lattice l,
                               int4 start) {
    fixed_sum out = {(vi)(0), (vi)(-1), (vi)(-1)};
    vi lane_x = TO_VI(LANE_X) * grid.x, lane_y = TO_VI(LANE_Y) * grid.y;
    vi px = start.x + lane_x * l.dx.x + lane_y * l.dy.x;
    vi py = start.y + lane_x * l.dx.y + lane_y * l.dy.y;
    vi pz = start.z + lane_x * l.dx.z + lane_y * l.dy.z;
    int face = -(1 << (l.bits - 1));
    for (int k = 0; k < grid.z; k++) {
        for (int j = 0; j < grid.y; j++) {
            int4 at = j * l.dy + k * l.dz;
            for (int i = 0; i < grid.x; i++, at += l.dx) {
                vi x = px + at.x, y = py + at.y, z = pz + at.z;
                vi in = MASK((x >= face) & (x <= limit.x) & (y >= face) & (y <= limit.y) & (z >= face) &
                             (z <= limit.z));
                fixed_cell c = fetch_fixed(halved, dims, x, y, z, l.bits);
                /* A byte below HALVED_LEAST borrows. */
                vu low = ((c.near - 0x02020202u) & ~c.near) | ((c.far - 0x02020202u) & ~c.far);
                out.whole &= in & MASK((low & 0x80808080u) == 0);
                out.empty &= ~in | MASK((c.near | c.far) == 0);
                out.sum += blend_fixed(c);
            }
        }
    }
    return out;
}

INLINE int all_lanes(vi mask) {
#if LANES == 16
    return all(mask);
#else
    return mask;
#endif
}

#if LANES == 16
#define RUN 8 /* packets of a row that a work item makes; the host's (scan_convert.c) */
#else
#define RUN 1
#endif

/* The packet's mean from the source's nearest voxels: two samples an axis where `halved` has one. */
INLINE vi nearest_mean(__global const uchar *voxels, int4 dims, int4 grid, lattice l, int4 start) {
    int4 first = 2 * start + (1 << l.bits) - (l.dx + l.dy + l.dz) / 2;
    vi packed = gather_nearest(voxels, dims, 2 * grid, l, first, 1);
    return mean_of(packed, 8 * grid.x * grid.y * grid.z);
}

/*
 * Arguments as convert_nearest, with the halved volume before them; positions are those of its voxels.
 * global: (runs of packets in a row, slices of the slab, rows of packets). A run goes past what lies outside
 * the volume at little cost: of a turned camera's box that is more than half.
 */
WIDE __kernel void convert_halved(__global const uchar *halved, int4 half_dims, __global const uchar *voxels,
                                  int4 dims, int4 grid, int4 origin, int4 dx, int4 dy, int4 dz, int4 size,
                                  int4 layout, __global uchar *slab, ulong offset) {
    int slice = (int)get_global_id(1), first = (int)get_global_id(0) * RUN * PACKET_W;
    place at = {first, (int)get_global_id(2) * PACKET_H, size.z + slice};
    lattice l = {origin, dx, dy, dz, size.w};
    int4 start = origin + at.x * grid.x * dx + at.y * grid.y * dy + at.z * grid.z * dz;
    int4 next = PACKET_W * grid.x * dx;
    int4 xs = (PACKET_W * grid.x - 1) * dx, ys = (PACKET_H * grid.y - 1) * dy, zs = (grid.z - 1) * dz;
    int4 low = start + min(xs, 0) + min(ys, 0) + min(zs, 0);
    int4 high = start + max(xs, 0) + max(ys, 0) + max(zs, 0);
    int4 limit = (dims - 1) << (l.bits - 1), near_face = (int4)(-(1 << (l.bits - 1))), far_face = limit;
    near_face.w = INT_MIN; /* there are three axes */
    far_face.w = INT_MAX;
    int samples = grid.x * grid.y * grid.z;
    for (; at.x < min(first + RUN * PACKET_W, size.x); at.x += PACKET_W) {
        vi mean = (vi)(0);
        if (!any(high<near_face | low> far_face)) {
            fixed_sum s = gather_halved(halved, half_dims, limit, grid, l, start);
            mean = select((vi)(0), rounded_mean(s.sum, (vi)(samples << WEIGHT_BITS)), s.whole);
            if (!all_lanes(s.whole | s.empty))
                mean = select(nearest_mean(voxels, dims, grid, l, start), mean, s.whole | s.empty);
        }
        store_packet(slab + offset, layout, size, at, slice, mean);
        start += next;
        low += next;
        high += next;
    }
}
