/* SPDX-License-Identifier: MIT */
/* The lit look (host_sim/render/dvr.c): a surface a ray, lit, with a veil of what is ghosted before
 * it. */
#define VEIL_OPACITY 0.35f /* of the thickest veil: what lies behind stays readable */
#define CUT_REACH    6.0f  /* samples behind the clipping surface in which a cut fades out */
#define CUT_FROM     0.25f /* mean opacity around the clipping surface from which on it cuts tissue ... */
#define CUT_ALL      0.5f  /* ... and where it does so wholly */
#define FACE_INSIDE  3.0f  /* samples behind the scan's face, where its echo is whole */

typedef struct {
    vf red, green, blue;
} colours;

INLINE colours mixed(colours a, colours b, vf t) {
    colours c = {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green),
                 a.blue + t * (b.blue - a.blue)};
    return c;
}

/* Skin that grows darker and redder with depth (t: 0 at the front of the box, 1 at its end). */
INLINE colours skin_at(vf t, float4 skin) {
    colours c = {skin.x * (1.0f - 0.30f * t), skin.y * (1.0f - 0.55f * t), skin.z * (1.0f - 0.62f * t)};
    return c;
}

/* Light of ambience and lamp on a surface without a colour, and its highlight. */
INLINE vf diffuse_of(directions n, float4 lamp, vf ambient, vf shadow) {
    return ambient * (0.24f + 0.24f * -n.z) + 0.58f * shadow * max(dot_of(n, lamp), 0.0f);
}
INLINE vf highlight_of(directions n, float4 half_way, vf shadow) {
    vf s = max(dot_of(n, half_way), 0.0f);
    s *= s;
    s *= s;
    s *= s;
    return 0.14f * shadow * s * s * s; /* the 24th power: broad, as on skin */
}

/* A place of the packet, by its samples. */
INLINE lit_place place_at(packet p, float4 dn, int px, int py, vf n) {
    lit_place at;
    at.at.x = p.x + n * dn.x;
    at.at.y = p.y + n * dn.y;
    at.at.z = p.z + n * dn.z;
    at.px = LANE_X + (float)px;
    at.py = LANE_Y + (float)py;
    at.n = n;
    return at;
}

/* How much of a surface at sample n is a cut: the clipping surface (at `at`) lies in tissue itself, or in a
 * dark speckle of it, and the surface is near. 0 on rays that nothing clips. */
INLINE vf cut_of(const lit_scene *s, lit_place at, vf here, vf n) {
    vf around;
    mean_opacities_at(s, &at, 1, &around);
    around = (around - CUT_FROM) * (1.0f / (CUT_ALL - CUT_FROM));
    vf near = clamp(1.0f - (n - at.n) * (1.0f / CUT_REACH), 0.0f, 1.0f);
    return select(near * clamp(max(here, around), 0.0f, 1.0f), (vf)(0.0f), MASK(at.n <= 0.0f));
}

/* The surface's colour. `cut`: 0 where it is tissue's own, 1 where it is the clipping surface's. The scan's
 * own face is a cut, too. */
INLINE colours surface_colour(const lit_scene *s, packet p, float4 dn, int px, int py, vf n, vf cut,
                              float4 lamp, float4 half_way, float4 skin) {
    lit_place at = place_at(p, dn, px, py, n);
    vf face;
    directions normal = normal_at(s, at.at, &face);
    vf t = clamp(n * skin.w, 0.0f, 1.0f);
    colours tone = skin_at(t, skin);
    if (lanes_max(cut) > 0.0f) {
        directions flat = map_normal(s, px, py);
        normal.x += cut * (flat.x - normal.x);
        normal.y += cut * (flat.y - normal.y);
        normal.z += cut * (flat.z - normal.z);
        normal = normalised(normal);
    }
    vf pale = max(cut, face);
    if (lanes_max(pale) > 0.0f) {
        vf grey = 0.3f * tone.red + 0.59f * tone.green + 0.11f * tone.blue;
        colours faded = {grey, grey, grey * 1.04f};
        tone = mixed(tone, faded, 0.7f * pale);
        /* Inside tissue the echo itself shows, as in a slice. */
        packet in = moved(s, at, normal, face * (-FACE_INSIDE / s->per_mm.z)).at;
        vf echo = blend_fused(fetch(s->smooth, s->dims, in.x, in.y, in.z)) * (1.0f / 255.0f);
        vf gain = 1.0f + pale * (0.55f + 0.6f * echo - 1.0f);
        tone.red *= gain;
        tone.green *= gain;
        tone.blue *= gain;
    }
    vf ambient = ambient_at(s, at, normal), shadow = shadow_at(s, at, normal, lamp);
    vf light = diffuse_of(normal, lamp, ambient, shadow);
    vf shine = highlight_of(normal, half_way, shadow) * (1.0f - pale);
    colours c = {tone.red * light + shine, tone.green * light + shine, tone.blue * light + shine};
    return c;
}

/* The veil: a cool light of its own, by its shape, so that nobody takes it for skin. */
INLINE colours veil_colour(const lit_scene *s, packet p, float4 dn, int px, int py, vf n, float4 lamp) {
    vf face;
    directions normal = normal_at(s, place_at(p, dn, px, py, n).at, &face);
    vf light = 0.35f + 0.35f * max(dot_of(normal, lamp), 0.0f);
    colours c = {0.62f * light, 0.78f * light, light};
    return c;
}

INLINE void store_colours(__global uchar *rgba, int4 map_dims, int px, int py, colours c) {
    float red[LANES], green[LANES], blue[LANES];
    STORE(c.red, red);
    STORE(c.green, green);
    STORE(c.blue, blue);
    for (int lane = 0; lane < LANES; lane++) {
        int x = px + lane % PACKET_W, y = py + lane / PACKET_W;
        if (x >= map_dims.z || y >= map_dims.w) continue;
        vstore4(convert_uchar4_sat_rte((float4)(red[lane], green[lane], blue[lane], 255.0f)),
                y * map_dims.z + x, rgba);
    }
}

/*
 * dims:       smoothed voxels, w: samples of a ray;  bricks: counts, largest value that is transparent
 * origin ...: voxel index of pixel 0, 0 at sample 0, and its growth a pixel and a sample
 * map_dims:   depthmap width (0: none), height, picture width, height
 * to_map:     pixels of the map a pixel of the picture in x and y, and where the picture begins in the map
 * to_samples: x samples a low-resolution slice, y sample of depth 0 where ghosting is over, z 1 / w (0: hard
 *             cut), w growth where nothing is sure; all in samples
 * window:     x T_L * 255, y 1 / ((T_H - T_L) * 255), z optical depth a sample at opacity 1, w gain
 * lamp, half_way: directions to the lamp, and between it and the viewer. skin: its colour, w the box' depth a
 * sample.
 */
WIDE __kernel void render_lit(__global const uchar *smooth, int4 dims, __global const uchar *grid,
                              int4 bricks, __global const uchar *opacity, int4 cells,
                              __global const uchar *scanned, int4 shares, float4 origin, float4 dx, float4 dy,
                              float4 dn, __global const float *map, __global const float *confidence,
                              int4 map_dims, float4 to_map, float4 to_samples, float4 window, float4 mx,
                              float4 my, float4 mz, float4 per_mm, float4 lamp, float4 half_way, float4 skin,
                              __global uchar *rgba) {
    int px = (int)get_global_id(0) * PACKET_W, py = (int)get_global_id(1) * PACKET_H;
    if (px >= map_dims.z || py >= map_dims.w) return;
    const lit_scene s = {smooth,   opacity, scanned, map, dims, cells,      shares,
                         map_dims, to_map,  mx,      my,  mz,   to_samples, per_mm};
    packet p = packet_at(px, py, origin, dx, dy);
    ghost_range ghost = ghost_range_of(map, confidence, map_dims, to_map, to_samples, px, py);
    vf first, end;
    clip_packet(p, dn, dims, &first, &end);
    bool veiled = to_samples.z > 0.0f;
    vf begin = max(first, floor(veiled ? ghost.rise : ghost.full) + 1.0f);
    int n = (int)clamp(lanes_min(begin), 0.0f, (float)dims.w), last = min((int)lanes_max(end) + 1, dims.w);
    met m = march(smooth, dims, grid, bricks, p, dn, ghost, window, veiled, n, last);

    colours c = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    vf cover = clamp(m.depth * (1.0f / SURFACE_DEPTH), 0.0f, 1.0f);
    if (lanes_max(cover) > 0.0f) {
        vf surface = select(m.at, surface_of(m, window.z), m.found);
        vf edge = edge_of(smooth, dims, p, dn, surface, ghost.full, window);
        vf cut = (vf)(0.0f);
        if (map_dims.x > 0) cut = cut_of(&s, place_at(p, dn, px, py, max(ghost.full, 0.0f)), m.cut, edge);
        colours lit = surface_colour(&s, p, dn, px, py, edge, cut, lamp, half_way, skin);
        c = mixed(c, lit, cover);
    }
    if (veiled && lanes_max(m.veil) > 0.0f) {
        vf share = VEIL_OPACITY * (1.0f - exp(-m.veil));
        c = mixed(c, veil_colour(&s, p, dn, px, py, m.veil_at, lamp), share);
    }
    float gain = 255.0f * window.w;
    c.red *= gain;
    c.green *= gain;
    c.blue *= gain;
    store_colours(rgba, map_dims, px, py, c);
}

#pragma OPENCL FP_CONTRACT OFF /* on since lit_light.cl */
