/* SPDX-License-Identifier: MIT */
/*
 * The renderer that the host does not have: render_volume (host_sim/render/cl/dvr.cl), whose samples come
 * straight from the grid of the probe. The rays, the places of their samples, the leaps over empty bricks of
 * the Cartesian copy, and the sums are the same, so the two differ in what a sample costs. Built behind the
 * host's files of base, base_rays, dvr, scan_convert and scan_convert_beams.
 */

/*
 * A packet's intensities at voxel indices x, y, z of the copy. to_mm: place of index 0 in mm from the array's
 * centre of curvature, and the edge of a voxel; the others as in convert_beams. What was not scanned is 0.
 */
INLINE vf sample_beams(__global const uchar *voxels, int4 dims, __global const float *theta,
                       __global const float *phi, float4 reach, float4 even, float4 to_mm, vf x, vf y, vf z) {
    x = to_mm.x + x * to_mm.w;
    y = to_mm.y + y * to_mm.w;
    z = to_mm.z + z * to_mm.w - reach.z;
    vf c = sqrt(y * y + z * z) + reach.z;
    vf r = (sqrt(x * x + c * c) - reach.x) * reach.y;
    vi in = within(r, dims.x);
    if (!any_lane(in)) return (vf)(0.0f);
    vf line = angle_index(theta, dims.y, even.xy, atan2(x, c));
    vf plane = angle_index(phi, dims.z, even.zw, atan2(reach.w * y, z));
    in &= within(line, dims.y) & within(plane, dims.z);
    return select((vf)(0.0f), blend(fetch(voxels, dims, r, line, plane)), in);
}

/* rest: x first step that is drawn, y width, z height of the picture. */
WIDE __kernel void render_beams(__global const uchar *beams, int4 beam_dims, __global const float *theta,
                                __global const float *phi, float4 reach, float4 even, float4 to_mm, int4 dims,
                                __global const uchar *grid, int4 bricks, float4 origin, float4 dx, float4 dy,
                                float4 dn, float4 rest, float4 window, float4 skin, __global uchar *rgba) {
    int px = (int)get_global_id(0) * PACKET_W, py = (int)get_global_id(1) * PACKET_H;
    int width = (int)rest.y, height = (int)rest.z;
    if (px >= width || py >= height) return;
    packet p = packet_at(px, py, origin, dx, dy);
    bounds b = packet_bounds(p);
    gathered g = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    vf first;
    clip_packet(p, dn, dims, &first, &g.end);
    first = max(first, (vf)(rest.x - HARD_CUT_MARGIN));
    int n = (int)clamp(ceil(lanes_min(select(first, (vf)((float)dims.w), MASK(first >= g.end)))), 0.0f,
                       (float)dims.w);
    float last = lanes_max(g.end);
    while ((float)n < last) {
        int run;
        if (packet_maximum(grid, bricks, b, dn, n, &run) <= bricks.w) {
            n += run;
            continue;
        }
        int stop = min(n + run, (int)last);
        for (; n < stop; n++) {
            float t = (float)n;
            vf value = sample_beams(beams, beam_dims, theta, phi, reach, even, to_mm, p.x + t * dn.x,
                                    p.y + t * dn.y, p.z + t * dn.z);
            vf alpha = clamp((value - window.x) * window.y, 0.0f, 1.0f);
            if (window.w != 1.0f) alpha = 1.0f - pow(1.0f - alpha, (vf)(window.w));
            alpha = select((vf)(0.0f), alpha, MASK((first <= t) & (g.end > t)));
            vf visible = (1.0f - g.opacity) * alpha;
            g.light += visible * value;
            g.opacity += visible;
            g.end = select(g.end, min(g.end, (vf)(t)), MASK(g.opacity >= window.z));
            last = lanes_max(g.end);
            if (last <= t + 1.0f) break;
        }
        if (n < stop) break;
    }
    float light[LANES];
    STORE(g.light, light);
    for (int lane = 0; lane < LANES; lane++) {
        int x = px + lane % PACKET_W, y = py + lane / PACKET_W;
        if (x >= width || y >= height) continue;
        float4 colour = (float4)(skin.xyz * light[lane], 255.0f);
        vstore4(convert_uchar4_sat_rte(colour), y * width + x, rgba);
    }
}
