/* SPDX-License-Identifier: MIT */
/*
 * Direct volume rendering, orthographic, front to back (thesis Eq. 3.22 - 3.24), with start depths and
 * ghosting (Eq. 3.25 as corrected by host_sim/render/dvr.h), early ray termination and leaps over bricks that
 * are transparent. A work item renders a packet of PACKET_W x PACKET_H pixels.
 */

/* A map at a pixel of the picture: bilinear between the map's pixel centres, clamped at its edges. */
INLINE float map_at(__global const float *map, int map_w, int map_h, float x, float y) {
    float px = clamp(x, 0.0f, (float)(map_w - 1)), py = clamp(y, 0.0f, (float)(map_h - 1));
    int x0 = (int)px, y0 = (int)py;
    int x1 = min(x0 + 1, map_w - 1), y1 = min(y0 + 1, map_h - 1);
    float fx = px - (float)x0, fy = py - (float)y0;
    float a = map[y0 * map_w + x0], b = map[y0 * map_w + x1];
    float c = map[y1 * map_w + x0], d = map[y1 * map_w + x1];
    a = a + fx * (b - a);
    c = c + fx * (d - c);
    return a + fy * (c - a);
}

/* The rays' opacity factor is (n - rise) * slope. */
typedef struct {
    vf rise;  /* steps: d_p - s - v. Far before the box where nothing is clipped. */
    vf slope; /* 1 / (w + v); 0 with a hard cut */
} ghost_window;

#define UNCLIPPED (-1e30f)
INLINE ghost_window ghost_window_of(__global const float *map, __global const float *confidence,
                                    int4 map_dims, float4 to_map, float4 to_steps, int px, int py) {
    ghost_window window = {(vf)(UNCLIPPED), (vf)(to_steps.z)};
    if (map_dims.x == 0) return window;
    float start[LANES], slope[LANES];
    for (int lane = 0; lane < LANES; lane++) {
        float x = ((float)(px + lane % PACKET_W) + 0.5f) * to_map.x + to_map.z - 0.5f;
        float y = ((float)(py + lane / PACKET_W) + 0.5f) * to_map.y + to_map.w - 0.5f;
        float depth = map_at(map, map_dims.x, map_dims.y, x, y);
        float growth = 0.0f;
        if (to_steps.w > 0.0f)
            growth = to_steps.w * (1.0f - map_at(confidence, map_dims.x, map_dims.y, x, y));
        /* Not finite: unknown, so nothing is clipped. */
        start[lane] = depth > 0.0f && depth < INFINITY
                          ? (depth + 0.5f) * to_steps.x - 0.5f - to_steps.y - growth
                          : UNCLIPPED;
        slope[lane] = to_steps.z / (1.0f + growth * to_steps.z);
    }
    window.rise = LOAD(start);
    if (to_steps.w > 0.0f) window.slope = LOAD(slope);
    return window;
}

/* What a ray has gathered so far. */
typedef struct {
    vf opacity, light; /* light: sum of intensity (0 .. 255) times visible opacity */
    vf end;            /* samples from here on are not needed; where it terminated, if it did */
} gathered;

/* What the rays sample: arguments of the kernel, and a packet's intensities at samples t. A program that
 * defines them before this file samples another grid (lab/bench/cl/probe_grid.cl). */
#ifndef SAMPLED
#define SAMPLED          __global const uchar *voxels
#define SAMPLE(p, dn, t) sample_packet(voxels, dims, p, dn, t)
#endif

#define HARD_CUT_MARGIN 1e-3f /* steps: a sample on the surface is drawn, whatever the rounding */

/*
 * window:   x T_L * 255, y 1 / ((T_H - T_L) * 255), z opacity at termination, w step in slices
 * to_steps: x steps per low-resolution slice, y s in steps, z 1 / w (0: hard cut), w w * g in steps (0: all
 *           is sure)
 * dims:     voxels, number of steps;  bricks: brick counts, largest value that is transparent
 * map_dims: depthmap width (0: none), height, picture width, height
 * to_map:   pixels of the map a pixel of the picture in x and y, and where the picture begins in the map
 */
WIDE __kernel void render_volume(SAMPLED, int4 dims, __global const uchar *grid, int4 bricks, float4 origin,
                                 float4 dx, float4 dy, float4 dn, __global const float *map, int4 map_dims,
                                 float4 to_map, float4 to_steps, float4 window, float4 skin,
                                 __global uchar *rgba, int want_rgba, __global float *termination,
                                 int want_termination, __global const float *confidence) {
    int px = (int)get_global_id(0) * PACKET_W, py = (int)get_global_id(1) * PACKET_H;
    int width = map_dims.z, height = map_dims.w;
    if (px >= width || py >= height) return;
    packet p = packet_at(px, py, origin, dx, dy);
    bounds b = packet_bounds(p);
    ghost_window ghost = ghost_window_of(map, confidence, map_dims, to_map, to_steps, px, py);
    vf rise = ghost.rise, slope = ghost.slope;

    gathered g = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    vf first;
    clip_packet(p, dn, dims, &first, &g.end);
    first = max(first, rise - HARD_CUT_MARGIN);
    int n = (int)clamp(ceil(lanes_min(select(first, (vf)((float)dims.w), MASK(first >= g.end)))), 0.0f,
                       (float)dims.w);
    float last = lanes_max(g.end);

    while ((float)n < last) {
        int run;
        int largest = packet_maximum(grid, bricks, b, dn, n, &run);
        if (largest <= bricks.w) {
            n += run;
            continue;
        }
        int stop = min(n + run, (int)last);
        for (; n < stop; n++) {
            float t = (float)n;
            vf value = SAMPLE(p, dn, t);
            vf alpha = clamp((value - window.x) * window.y, 0.0f, 1.0f);
            if (to_steps.z > 0.0f) alpha *= clamp((t - rise) * slope, 0.0f, 1.0f);
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

    float opacity[LANES], light[LANES], end[LANES];
    STORE(g.opacity, opacity);
    STORE(g.light, light);
    STORE(g.end, end);
    for (int lane = 0; lane < LANES; lane++) {
        int x = px + lane % PACKET_W, y = py + lane / PACKET_W;
        if (x >= width || y >= height) continue;
        int pixel = y * width + x;
        if (want_rgba) {
            float4 colour = (float4)(skin.xyz * light[lane], 255.0f);
            vstore4(convert_uchar4_sat_rte(colour), pixel, rgba);
        }
        if (want_termination) termination[pixel] = opacity[lane] >= window.z ? end[lane] : (float)dims.w;
    }
}
