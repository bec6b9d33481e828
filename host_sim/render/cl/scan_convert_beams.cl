/* SPDX-License-Identifier: MIT */
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
