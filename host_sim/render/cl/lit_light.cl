/* SPDX-License-Identifier: MIT */
/*
 * Light on a surface (host_sim/render/dvr_lit.h): normals, the clipping surface's own normal, ambient
 * occlusion and shadow from the coarse opacities, and the colour of it all. Directions are in camera
 * coordinates: x right, y down, z away from the viewer.
 */
typedef struct {
    vf x, y, z;
} directions;

INLINE vf dot_of(directions a, float4 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

INLINE directions normalised(directions d) {
    vf scale = 1.0f / sqrt(max(d.x * d.x + d.y * d.y + d.z * d.z, 1e-20f));
    directions out = {d.x * scale, d.y * scale, d.z * scale};
    return out;
}

/* The scene as light sees it. */
typedef struct {
    __global const uchar *smooth, *opacity;
    __global const float *map;
    int4 dims, cells, map_dims; /* cells.w: smoothed voxels a cell's edge */
    float4 to_map;              /* as render_lit takes it */
    float4 mx, my, mz;          /* voxels of x, y, z a millimetre along the camera's axes; mx.w: see SPEED */
    float4 to_samples;          /* as render_lit takes it */
    float4 per_mm;              /* pixels in x, pixels in y, samples a millimetre; w: unit of light, mm */
} lit_scene;

/* Weights of the quadratic B-spline and of its slope around the nearest voxel; f in -0.5 .. 0.5. */
INLINE void spline_weights(vf f, vf weight[3], vf slope[3]) {
    weight[0] = 0.5f * (0.5f - f) * (0.5f - f);
    weight[1] = 0.75f - f * f;
    weight[2] = 0.5f * (0.5f + f) * (0.5f + f);
    slope[0] = f - 0.5f;
    slope[1] = -2.0f * f;
    slope[2] = f + 0.5f;
}

/* Four neighbours in x as one word, of the three rows around y, for every lane; vload4 asks for byte
 * alignment only. The fourth is not used: it may be the byte behind the last voxel. */
INLINE void fetch_rows(__global const uchar *p, int row, vi i, vu words[3]) {
#if LANES == 16
    int at[LANES];
    uint out[3 * LANES];
    STORE(i, at);
    for (int lane = 0; lane < LANES; lane++) {
        long o = at[lane];
        for (int y = 0; y < 3; y++) out[y * LANES + lane] = as_uint(vload4(0, p + (y - 1) * row + o));
    }
    for (int y = 0; y < 3; y++) words[y] = LOAD(out + y * LANES);
#else
    for (int y = 0; y < 3; y++) words[y] = as_uint(vload4(0, p + (y - 1) * row + i));
#endif
}

#ifdef __ENDIAN_LITTLE__
#define LEVEL_OF(word, x) TO_VF(((word) >> (8 * (x))) & 0xffu)
#else
#define LEVEL_OF(word, x) TO_VF(((word) >> (24 - 8 * (x))) & 0xffu)
#endif

INLINE vi spline_voxel(vf position, int count, vf *fraction) {
    vf p = clamp(position, 1.0f, (float)(count - 2));
    vi i = TO_VI(p + 0.5f);
    *fraction = p - TO_VF(i);
    return i;
}

/* The gradient of the smoothed volume's quadratic B-spline, grey levels a millimetre. */
INLINE directions gradient_at(const lit_scene *s, packet at) {
    vf fx, fy, fz, wx[3], wy[3], wz[3], dx[3], dy[3], dz[3];
    vi ix = spline_voxel(at.x, s->dims.x, &fx), iy = spline_voxel(at.y, s->dims.y, &fy);
    vi iz = spline_voxel(at.z, s->dims.z, &fz);
    spline_weights(fx, wx, dx);
    spline_weights(fy, wy, dy);
    spline_weights(fz, wz, dz);
    vi i = (iz * s->dims.y + iy) * s->dims.x + ix;
    directions g = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    for (int z = 0; z < 3; z++) {
        directions plane = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
        vu words[3];
        fetch_rows(s->smooth + (z - 1) * s->dims.y * s->dims.x - 1, s->dims.x, i, words);
        for (int y = 0; y < 3; y++) {
            vf a = LEVEL_OF(words[y], 0), b = LEVEL_OF(words[y], 1), c = LEVEL_OF(words[y], 2);
            vf along = dx[0] * a + dx[1] * b + dx[2] * c, value = wx[0] * a + wx[1] * b + wx[2] * c;
            plane.x += wy[y] * along;
            plane.y += dy[y] * value;
            plane.z += wy[y] * value;
        }
        g.x += wz[z] * plane.x;
        g.y += wz[z] * plane.y;
        g.z += dz[z] * plane.z;
    }
    directions out = {s->mx.x * g.x + s->my.x * g.y + s->mz.x * g.z,
                      s->mx.y * g.x + s->my.y * g.y + s->mz.y * g.z,
                      s->mx.z * g.x + s->my.z * g.y + s->mz.z * g.z};
    return out;
}

/* Towards the viewer where there is no gradient to tell; never away from him. */
INLINE directions normal_at(const lit_scene *s, packet at) {
    directions g = gradient_at(s, at);
    directions n = {-g.x, -g.y, -fabs(g.z) - s->mx.w};
    return normalised(n);
}

INLINE bool is_depth(float depth) {
    return depth > 0.0f && depth < INFINITY;
}

#define MAP_REACH 2.0f /* pixels of the depthmap to either side: its slope is rougher than it is */

/* The clipping surface's normal under a packet's pixels. */
INLINE directions map_normal(const lit_scene *s, int px, int py) {
    float nx[LANES], ny[LANES];
    for (int lane = 0; lane < LANES; lane++) {
        float x = ((float)(px + lane % PACKET_W) + 0.5f) * s->to_map.x + s->to_map.z - 0.5f;
        float y = ((float)(py + lane / PACKET_W) + 0.5f) * s->to_map.y + s->to_map.w - 0.5f;
        float left = map_at(s->map, s->map_dims.x, s->map_dims.y, x - MAP_REACH, y);
        float right = map_at(s->map, s->map_dims.x, s->map_dims.y, x + MAP_REACH, y);
        float above = map_at(s->map, s->map_dims.x, s->map_dims.y, x, y - MAP_REACH);
        float below = map_at(s->map, s->map_dims.x, s->map_dims.y, x, y + MAP_REACH);
        bool flat = !(is_depth(left) && is_depth(right) && is_depth(above) && is_depth(below));
        /* Millimetres a slice of difference, over 2 * MAP_REACH pixels. */
        float mm = 0.5f / MAP_REACH * s->to_samples.x / s->per_mm.z;
        nx[lane] = flat ? 0.0f : (right - left) * mm * s->per_mm.x * s->to_map.x;
        ny[lane] = flat ? 0.0f : (below - above) * mm * s->per_mm.y * s->to_map.y;
    }
    directions n = {LOAD(nx), LOAD(ny), (vf)(-1.0f)};
    return normalised(n);
}

/* Where light passes: voxel index, pixel and sample of a packet. */
typedef struct {
    packet at;
    vf px, py, n;
} lit_place;

INLINE lit_place moved(const lit_scene *s, lit_place from, directions d, vf mm) {
    vf x = d.x * mm, y = d.y * mm, z = d.z * mm;
    lit_place to;
    to.at.x = from.at.x + s->mx.x * x + s->mx.y * y + s->mx.z * z;
    to.at.y = from.at.y + s->my.x * x + s->my.y * y + s->my.z * z;
    to.at.z = from.at.z + s->mz.x * x + s->mz.y * y + s->mz.z * z;
    to.px = from.px + x * s->per_mm.x;
    to.py = from.py + y * s->per_mm.y;
    to.n = from.n + z * s->per_mm.z;
    return to;
}

/* -1 where a place lies in tissue that the clipping surface has removed. */
INLINE vi removed(const lit_scene *s, lit_place p) {
    vi x = TO_VI(clamp((p.px + 0.5f) * s->to_map.x + s->to_map.z, 0.0f, (float)(s->map_dims.x - 1)));
    vi y = TO_VI(clamp((p.py + 0.5f) * s->to_map.y + s->to_map.w, 0.0f, (float)(s->map_dims.y - 1)));
    vi i = y * s->map_dims.x + x;
#if LANES == 16
    int at[LANES];
    float depth[LANES];
    vstore16(i, 0, at);
    for (int lane = 0; lane < LANES; lane++) depth[lane] = s->map[at[lane]];
    vf d = LOAD(depth);
#else
    vf d = s->map[i];
#endif
    return MASK((d > 0.0f) & (d < INFINITY) & (p.n < d * s->to_samples.x + s->to_samples.y));
}

/* Mean opacities at so many places, MOST_PACKETS at most, 0 .. 1; none outside the volume. */
INLINE void mean_opacities_at(const lit_scene *s, const lit_place *p, int count, vf *value) {
    float block = (float)s->cells.w, shift = 0.5f * (block - 1.0f), scale = 1.0f / block;
    packet at[MOST_PACKETS];
    cell c[MOST_PACKETS];
    for (int i = 0; i < count; i++) {
        packet here = {(p[i].at.x - shift) * scale, (p[i].at.y - shift) * scale, (p[i].at.z - shift) * scale};
        at[i] = here;
    }
    fetch_together(s->opacity, s->cells, at, count, c);
    for (int i = 0; i < count; i++) {
        vf x = at[i].x, y = at[i].y, z = at[i].z;
        vi outside = MASK((min(x, min(y, z)) < -0.5f) | (x > (float)s->cells.x - 0.5f) |
                          (y > (float)s->cells.y - 0.5f) | (z > (float)s->cells.z - 0.5f));
        value[i] = select(blend(c[i]) * (1.0f / 255.0f), (vf)(0.0f), outside);
    }
}

/* The same, and none in what was removed. */
INLINE void opacities_at(const lit_scene *s, const lit_place *p, int count, vf *value) {
    mean_opacities_at(s, p, count, value);
    if (s->map_dims.x == 0) return;
    for (int i = 0; i < count; i++) value[i] = select(value[i], (vf)(0.0f), removed(s, p[i]));
}

#define LIGHT_TOGETHER 3 /* samples of light */
#define SHADOW_REACH   6 /* of them along the lamp's direction */

/* How much of the surroundings' light arrives: 1 on anything convex that stands free. */
INLINE vf ambient_at(const lit_scene *s, lit_place p, directions n) {
    const float reach[LIGHT_TOGETHER] = {4.0f, 7.0f, 11.0f}, weight[LIGHT_TOGETHER] = {0.4f, 0.25f, 0.15f};
    lit_place at[LIGHT_TOGETHER];
    vf light = (vf)(1.0f), opacity[LIGHT_TOGETHER];
    for (int i = 0; i < LIGHT_TOGETHER; i++) at[i] = moved(s, p, n, (vf)(reach[i] * s->per_mm.w));
    opacities_at(s, at, LIGHT_TOGETHER, opacity);
    for (int i = 0; i < LIGHT_TOGETHER; i++) light -= weight[i] * opacity[i];
    return light;
}

/* How much of the lamp's light arrives; from a place above the surface, so that it does not shade itself. */
INLINE vf shadow_at(const lit_scene *s, lit_place p, directions n, float4 lamp) {
    directions l = {(vf)(lamp.x), (vf)(lamp.y), (vf)(lamp.z)};
    lit_place start = moved(s, p, n, (vf)(4.0f * s->per_mm.w)), at[LIGHT_TOGETHER];
    vf depth = (vf)(0.0f), opacity[LIGHT_TOGETHER];
    for (int first = 1; first <= SHADOW_REACH; first += LIGHT_TOGETHER) {
        for (int i = 0; i < LIGHT_TOGETHER; i++)
            at[i] = moved(s, start, l, (vf)(3.0f * (float)(first + i) * s->per_mm.w));
        opacities_at(s, at, LIGHT_TOGETHER, opacity);
        for (int i = 0; i < LIGHT_TOGETHER; i++) depth += opacity[i];
    }
    return 1.0f / (1.0f + depth * depth);
}
