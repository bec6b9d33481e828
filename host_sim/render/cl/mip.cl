/* SPDX-License-Identifier: MIT */
/* Maximum intensity projection of the renderer's view: the same rays, the same samples. */
WIDE __kernel void project_maximum(__global const uchar *voxels, int4 dims, __global const uchar *grid,
                                   int4 bricks, float4 origin, float4 dx, float4 dy, float4 dn, int4 picture,
                                   __global uchar *gray) {
    int px = (int)get_global_id(0) * PACKET_W, py = (int)get_global_id(1) * PACKET_H;
    if (px >= picture.x || py >= picture.y) return;
    packet p = packet_at(px, py, origin, dx, dy);
    bounds b = packet_bounds(p);
    vf first, end, largest = (vf)(0.0f);
    clip_packet(p, dn, dims, &first, &end);
    int n =
        (int)clamp(lanes_min(select(first, (vf)((float)dims.w), MASK(first >= end))), 0.0f, (float)dims.w);
    int last = (int)lanes_max(end);
    /* Rays that miss the volume must not keep the others from leaping. */
    vf needed = select((vf)(0.0f), (vf)(255.0f), MASK(first >= end));
    while (n < last) {
        int run;
        /* A brick no brighter than what every ray has seen changes nothing. */
        int reachable = packet_maximum(grid, bricks, b, dn, n, &run);
        if ((float)reachable <= lanes_min(max(largest, needed)) && bricks.w >= 0) {
            n += run;
            continue;
        }
        for (int stop = min(n + run, last); n < stop; n++) {
            float t = (float)n;
            vf value = sample_packet(voxels, dims, p, dn, t);
            largest = max(largest, select((vf)(0.0f), value, MASK((first <= t) & (end > t))));
        }
    }
    float seen[LANES];
    STORE(largest, seen);
    for (int lane = 0; lane < LANES; lane++) {
        int x = px + lane % PACKET_W, y = py + lane / PACKET_W;
        if (x < picture.x && y < picture.y) gray[y * picture.x + x] = convert_uchar_sat_rte(seen[lane]);
    }
}
