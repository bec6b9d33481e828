/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion: source volume -> one slab of the low-resolution, camera-aligned volume
 * (host_sim/render/scan_convert.h defines the result). A work item makes a packet of PACKET_W x PACKET_H
 * voxels of a slice. A low-resolution voxel is the mean of grid.x * grid.y * grid.z samples at regular places
 * in its box.
 */
#define PACKED_ONE (1 << 20) /* sum of intensities in the low bits, number of scanned samples above */

typedef struct {
    int x, y, z; /* of the packet's first voxel; z: slice of the whole volume */
} place;

/* Where the tile of a slice begins. */
INLINE __global uchar *tile_of(__global uchar *slab, int4 layout, int slice) {
    return slab + (size_t)(slice / layout.x) * layout.z * layout.w + (size_t)(slice % layout.x) * layout.y;
}

/* Writes the packet's bytes into its tile, and only those inside the picture. */
INLINE void store_packet(__global uchar *slab, int4 layout, int4 size, place at, int slice, vi value) {
    __global uchar *tile = tile_of(slab, layout, slice);
#if LANES == 16
    if (at.x + PACKET_W <= size.x && at.y + PACKET_H <= size.y) {
        uchar16 bytes = convert_uchar16(value);
        __global uchar *row = tile + (size_t)at.y * layout.w + at.x;
        vstore4(bytes.s0123, 0, row);
        vstore4(bytes.s4567, 0, row + layout.w);
        vstore4(bytes.s89ab, 0, row + 2 * layout.w);
        vstore4(bytes.scdef, 0, row + 3 * layout.w);
        return;
    }
#endif
    int values[LANES];
    STORE(value, values);
    for (int lane = 0; lane < LANES; lane++) {
        int x = at.x + lane % PACKET_W, y = at.y + lane / PACKET_W;
        if (x < size.x && y < size.y) tile[(size_t)y * layout.w + x] = (uchar)values[lane];
    }
}

#if LANES == 16
#define BYTES(p, i)                                                                                          \
    convert_int16((uchar16)((p)[i.s0], (p)[i.s1], (p)[i.s2], (p)[i.s3], (p)[i.s4], (p)[i.s5], (p)[i.s6],     \
                            (p)[i.s7], (p)[i.s8], (p)[i.s9], (p)[i.sa], (p)[i.sb], (p)[i.sc], (p)[i.sd],     \
                            (p)[i.se], (p)[i.sf]))
#else
#define BYTES(p, i) ((int)(p)[i])
#endif

/* Sample (i, j, k) of the volume stands at origin + i * dx + j * dy + k * dz, in voxels with `bits` fraction
 * bits. The host chooses them so that nothing overflows; half a voxel is in `origin`, so that the nearest
 * voxel is a floor. */
typedef struct {
    int4 origin, dx, dy, dz;
    int bits;
} lattice;

/* How many of a packet's samples lie inside the volume along one axis: 0 none, 1 some, 2 all. */
INLINE int packet_inside(int start, int x_span, int y_span, int z_span, int count, int bits) {
    int low = (start + min(x_span, 0) + min(y_span, 0) + min(z_span, 0)) >> bits;
    int high = (start + max(x_span, 0) + max(y_span, 0) + max(z_span, 0)) >> bits;
    if (high < 0 || low >= count) return 0;
    return low >= 0 && high < count ? 2 : 1;
}

/* Sum and number of the packet's scanned samples, packed. */
INLINE vi gather_nearest(__global const uchar *voxels, int4 dims, int4 grid, lattice l, int4 start,
                         int guard) {
    vi packed = (vi)(0), lane_x = TO_VI(LANE_X) * grid.x, lane_y = TO_VI(LANE_Y) * grid.y;
    vi px = start.x + lane_x * l.dx.x + lane_y * l.dy.x;
    vi py = start.y + lane_x * l.dx.y + lane_y * l.dy.y;
    vi pz = start.z + lane_x * l.dx.z + lane_y * l.dy.z;
    for (int j = 0; j < grid.y; j++) {
        for (int i = 0; i < grid.x; i++) {
            int4 at = i * l.dx + j * l.dy;
            for (int k = 0; k < grid.z; k++, at += l.dz) {
                vi x = (px + at.x) >> l.bits, y = (py + at.y) >> l.bits, z = (pz + at.z) >> l.bits;
                vi index = (z * dims.y + y) * dims.x + x;
                vi value;
                if (guard) {
                    vi in = MASK((x >= 0) & (x < dims.x) & (y >= 0) & (y < dims.y) & (z >= 0) & (z < dims.z));
                    index &= in;
                    value = BYTES(voxels, index) & in;
                } else {
                    value = BYTES(voxels, index);
                }
                packed += value + (MASK(value != 0) & PACKED_ONE);
            }
        }
    }
    return packed;
}

/* The mean of the scanned ones of so many samples; 0 if they are less than half of them. */
INLINE vi mean_of(vi packed, int samples) {
    vi sum = packed & (PACKED_ONE - 1), count = packed >> 20;
    vi mean = clamp(rounded_mean(sum, max(count, (vi)(1))), 1, 255);
    return select(mean, (vi)(0), MASK(2 * count < samples));
}

/*
 * Means of nearest voxels, in integers: for voxels of the low-resolution volume that span several of the
 * source. size: width, height, first slice, fraction bits; layout: tiles_x, tile_w, tile_h, row_pitch.
 * global: (packets in a row, slices of the slab, rows of packets). The rows of packets come last: a slab's
 * section through a few rows is small enough for the cache, whatever the camera, and its neighbours share
 * cache lines.
 */
WIDE __kernel void convert_nearest(__global const uchar *voxels, int4 dims, int4 grid, int4 origin, int4 dx,
                                   int4 dy, int4 dz, int4 size, int4 layout, __global uchar *slab,
                                   ulong offset) {
    int slice = (int)get_global_id(1);
    place at = {(int)get_global_id(0) * PACKET_W, (int)get_global_id(2) * PACKET_H, size.z + slice};
    lattice l = {origin, dx, dy, dz, size.w};
    int4 start = origin + at.x * grid.x * dx + at.y * grid.y * dy + at.z * grid.z * dz;
    int4 xs = (PACKET_W * grid.x - 1) * dx, ys = (PACKET_H * grid.y - 1) * dy, zs = (grid.z - 1) * dz;
    int in_x = packet_inside(start.x, xs.x, ys.x, zs.x, dims.x, l.bits);
    int in_y = packet_inside(start.y, xs.y, ys.y, zs.y, dims.y, l.bits);
    int in_z = packet_inside(start.z, xs.z, ys.z, zs.z, dims.z, l.bits);
    int inside = min(in_x, min(in_y, in_z));
    vi mean = (vi)(0);
    if (inside > 0) {
        vi packed = inside == 2 ? gather_nearest(voxels, dims, grid, l, start, 0)
                                : gather_nearest(voxels, dims, grid, l, start, 1);
        mean = mean_of(packed, grid.x * grid.y * grid.z);
    }
    store_packet(slab + offset, layout, size, at, slice, mean);
}

/* The same cell with 1 for every scanned voxel: its blend is the scanned share of a sample. */
INLINE vu scanned_bytes(vu square) {
    square |= square >> 4;
    square |= square >> 2;
    square |= square >> 1;
    return square & 0x01010101u;
}
INLINE cell scanned(cell c) {
    c.near = scanned_bytes(c.near);
    c.far = scanned_bytes(c.far);
    return c;
}

INLINE vi in_box(vf position, int count) {
    return MASK((position >= -BOX_HALF_VOXEL) & (position <= (float)(count - 1) + BOX_HALF_VOXEL));
}

#define HALF_COVERED 0.4995f /* of the samples: rounding never decides about a voxel exactly half covered */

/*
 * Means of trilinear samples: for voxels of the low-resolution volume about as small as the source's.
 * origin, dx, dy, dz: voxel index of sample (0, 0, 0) and its steps along the samples' grid.
 */
WIDE __kernel void convert_trilinear(__global const uchar *voxels, int4 dims, int4 grid, float4 origin,
                                     float4 dx, float4 dy, float4 dz, int4 size, int4 layout,
                                     __global uchar *slab, ulong offset) {
    int slice = (int)get_global_id(1);
    place at = {(int)get_global_id(0) * PACKET_W, (int)get_global_id(2) * PACKET_H, size.z + slice};
    vf sum = (vf)(0.0f), share = (vf)(0.0f);
    for (int k = 0; k < grid.z; k++) {
        float w = (float)(at.z * grid.z + k);
        for (int j = 0; j < grid.y; j++) {
            vf v = (LANE_Y + (float)at.y) * (float)grid.y + (float)j;
            for (int i = 0; i < grid.x; i++) {
                vf u = (LANE_X + (float)at.x) * (float)grid.x + (float)i;
                vf x = origin.x + u * dx.x + v * dy.x + w * dz.x;
                vf y = origin.y + u * dx.y + v * dy.y + w * dz.y;
                vf z = origin.z + u * dx.z + v * dy.z + w * dz.z;
                vi in = in_box(x, dims.x) & in_box(y, dims.y) & in_box(z, dims.z);
                cell c = fetch(voxels, dims, x, y, z);
                sum += select((vf)(0.0f), blend(c), in);
                share += select((vf)(0.0f), blend(scanned(c)), in);
            }
        }
    }
    vi mean = TO_VI(clamp(floor(sum / max(share, (vf)(1e-6f)) + 0.5f), 1.0f, 255.0f));
    mean = select(mean, (vi)(0), MASK(share < HALF_COVERED * (float)(grid.x * grid.y * grid.z)));
    store_packet(slab + offset, layout, size, at, slice, mean);
}

/*
 * Scan conversion straight from probe geometry, in one step: samples (radius, line, plane) -> one slab of the
 * low-resolution, camera-aligned volume (host_sim/render/scan_convert.h defines the result).
 */

/* Entries of a table at 16 places. */
#if LANES == 16
#define ENTRIES(p, i)                                                                                        \
    ((float16)((p)[i.s0], (p)[i.s1], (p)[i.s2], (p)[i.s3], (p)[i.s4], (p)[i.s5], (p)[i.s6], (p)[i.s7],       \
               (p)[i.s8], (p)[i.s9], (p)[i.sa], (p)[i.sb], (p)[i.sc], (p)[i.sd], (p)[i.se], (p)[i.sf]))
#else
#define ENTRIES(p, i) ((p)[i])
#endif

/*
 * Where angles lie in a table of `count` of them that ascend or descend, linearly between two; what lies
 * beyond them gets an index below 0 or above count - 1. even: the first angle, and the steps a radian; 0
 * steps: they are uneven, and halving the table finds the two.
 */
INLINE vf angle_index(__global const float *table, int count, float2 even, vf angle) {
    if (even.y != 0.0f) return (angle - even.x) * even.y;
    float sign = table[count - 1] > table[0] ? 1.0f : -1.0f;
    vi low = (vi)(0), high = (vi)(count - 1);
    for (int left = count - 1; left > 1; left = (left + 1) / 2) {
        vi middle = (low + high) / 2;
        vi before = MASK(sign * angle < sign * ENTRIES(table, middle));
        high = select(high, middle, before);
        low = select(middle, low, before);
    }
    high = min(low + 1, (vi)(count - 1));
    low = high - 1;
    vf first = ENTRIES(table, low);
    return TO_VF(low) + (angle - first) / (ENTRIES(table, high) - first);
}

INLINE vi within(vf index, int count) {
    return MASK((index >= 0.0f) & (index <= (float)(count - 1)));
}

INLINE int any_lane(vi mask) {
#if LANES == 16
    return any(mask);
#else
    return mask;
#endif
}

/*
 * A packet's intensities at places in mm from the array's centre of curvature, linear between echoes; 0 where
 * nothing was scanned. *in: -1 where something was. dims: samples, lines, planes; reach: start [mm], samples
 * a mm, axis [mm], side; even: of theta (xy) and phi (zw).
 *
 * atan2 tells what lies behind the sweep's axis or behind the array from what was scanned: its angle is more
 * than a right one, and no table reaches that.
 */
INLINE vf echoes_at(__global const uchar *voxels, int4 dims, __global const float *theta,
                    __global const float *phi, float4 reach, float4 even, packet at, vi *in) {
    vf z = at.z - reach.z;
    vf c = sqrt(at.y * at.y + z * z) + reach.z;
    vf r = (sqrt(at.x * at.x + c * c) - reach.x) * reach.y;
    *in = within(r, dims.x);
    if (!any_lane(*in)) return (vf)(0.0f);
    vf line = angle_index(theta, dims.y, even.xy, atan2(at.x, c));
    vf plane = angle_index(phi, dims.z, even.zw, atan2(reach.w * at.y, z));
    *in &= within(line, dims.y) & within(plane, dims.z);
    return select((vf)(0.0f), blend(fetch(voxels, dims, r, line, plane)), *in);
}

/*
 * voxels to even: as echoes_at. origin, dx, dy, dz: place of sample (0, 0, 0) of the low-resolution volume
 * and its steps, in mm from the array's centre of curvature. The others are those of convert_trilinear.
 */
WIDE __kernel void convert_beams(__global const uchar *voxels, int4 dims, __global const float *theta,
                                 __global const float *phi, float4 reach, float4 even, int4 grid,
                                 float4 origin, float4 dx, float4 dy, float4 dz, int4 size, int4 layout,
                                 __global uchar *slab, ulong offset) {
    int slice = (int)get_global_id(1);
    place at = {(int)get_global_id(0) * PACKET_W, (int)get_global_id(2) * PACKET_H, size.z + slice};
    vf sum = (vf)(0.0f);
    vi count = (vi)(0);
    for (int k = 0; k < grid.z; k++) {
        float w = (float)(at.z * grid.z + k);
        for (int j = 0; j < grid.y; j++) {
            vf v = (LANE_Y + (float)at.y) * (float)grid.y + (float)j;
            for (int i = 0; i < grid.x; i++) {
                vf u = (LANE_X + (float)at.x) * (float)grid.x + (float)i;
                packet mm = {origin.x + u * dx.x + v * dy.x + w * dz.x,
                             origin.y + u * dx.y + v * dy.y + w * dz.y,
                             origin.z + u * dx.z + v * dy.z + w * dz.z};
                vi in;
                sum += echoes_at(voxels, dims, theta, phi, reach, even, mm, &in);
                count -= in;
            }
        }
    }
    vi mean = TO_VI(clamp(floor(sum / TO_VF(max(count, (vi)(1))) + 0.5f), 1.0f, 255.0f));
    mean = select(mean, (vi)(0), MASK(2 * count < grid.x * grid.y * grid.z));
    store_packet(slab + offset, layout, size, at, slice, mean);
}
