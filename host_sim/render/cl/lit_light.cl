/* SPDX-License-Identifier: MIT */
/*
 * Light on a surface (host_sim/render/dvr.c): normals, the clipping surface's own normal, ambient
 * occlusion and shadow from the coarse opacities, and the colour of it all. Directions are in camera
 * coordinates: x right, y down, z away from the viewer.
 */
/* The lit look may be a little different on every device: it is faster so. */
#pragma OPENCL FP_CONTRACT ON

#define LIT_PAD   2 /* empty voxels around the smoothed volume; the host's (derived_volume.h) */
#define SHARE_PAD 2 /* empty cubes around the share of the scan; the host's (derived_volume.h) */

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
    __global const uchar *smooth, *opacity, *scanned;
    __global const float *map;
    int4 dims, cells, shares, map_dims; /* cells.w, shares.w: smoothed voxels along an edge */
    float4 to_map;                      /* as render_lit takes it */
    float4 mx, my, mz; /* voxels of x, y, z a millimetre along the camera's axes; mx.w: see SPEED */
    float4 to_samples; /* as render_lit takes it */
    float4 per_mm;     /* pixels in x, pixels in y, samples a millimetre; w: unit of light, mm */
} lit_scene;

/* Weights of the cubic B-spline and of its slope around a place; f in 0 .. 1 from the second voxel on. */
INLINE void spline_weights(vf f, vf weight[4], vf slope[4]) {
    vf r = 1.0f - f;
    weight[0] = (1.0f / 6.0f) * r * r * r;
    weight[1] = (2.0f / 3.0f) - 0.5f * f * f * (1.0f + r);
    weight[2] = (2.0f / 3.0f) - 0.5f * r * r * (1.0f + f);
    weight[3] = (1.0f / 6.0f) * f * f * f;
    slope[0] = -0.5f * r * r;
    slope[1] = f * (1.5f * f - 2.0f);
    slope[2] = -r * (1.5f * r - 2.0f);
    slope[3] = 0.5f * f * f;
}

/* Four neighbours in x as one word, wherever it stands; PoCL makes two words of a vload4. */
typedef struct __attribute__((packed)) {
    uint four;
} unaligned;
#define FOUR(p, i) (((__global const unaligned *)((p) + (i)))->four)
#if LANES == 16
typedef uint16 vfour;
#define FOURS(p, i)                                                                                          \
    ((uint16)(FOUR(p, i.s0), FOUR(p, i.s1), FOUR(p, i.s2), FOUR(p, i.s3), FOUR(p, i.s4), FOUR(p, i.s5),      \
              FOUR(p, i.s6), FOUR(p, i.s7), FOUR(p, i.s8), FOUR(p, i.s9), FOUR(p, i.sa), FOUR(p, i.sb),      \
              FOUR(p, i.sc), FOUR(p, i.sd), FOUR(p, i.se), FOUR(p, i.sf)))
#else
typedef uint vfour;
#define FOURS(p, i) FOUR(p, i)
#endif
#ifdef __ENDIAN_LITTLE__
#define OF_FOUR(four, k) TO_VF((four) >> (8u * (k)) & 0xffu)
#else
#define OF_FOUR(four, k) TO_VF((four) >> (8u * (3 - (k))) & 0xffu)
#endif

/* The second of the four voxels around a place, between the outermost ones of an axis. */
INLINE vi spline_voxel(vf position, int count, vf *fraction) {
    vf p = clamp(position, 1.0f, (float)(count - 2));
    vi i = min(TO_VI(p), (vi)(count - 3));
    *fraction = p - TO_VF(i);
    return i;
}

/* The gradient of the cubic B-spline of `voxels`, levels a millimetre where they are smoothed ones. */
INLINE directions gradient_at(const lit_scene *s, __global const uchar *voxels, int4 dims, packet at) {
    vf fx, fy, fz, wx[4], wy[4], wz[4], dx[4], dy[4], dz[4];
    vi ix = spline_voxel(at.x, dims.x, &fx), iy = spline_voxel(at.y, dims.y, &fy);
    vi iz = spline_voxel(at.z, dims.z, &fz);
    spline_weights(fx, wx, dx);
    spline_weights(fy, wy, dy);
    spline_weights(fz, wz, dz);
    vi i = (iz * dims.y + iy) * dims.x + ix;
    directions g = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    for (int z = 0; z < 4; z++) {
        directions plane = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
        for (int y = 0; y < 4; y++) {
            __global const uchar *row = voxels + ((z - 1) * dims.y + y - 1) * dims.x - 1;
            vfour four = FOURS(row, i);
            vf a = OF_FOUR(four, 0), b = OF_FOUR(four, 1), c = OF_FOUR(four, 2), d = OF_FOUR(four, 3);
            vf value = wx[0] * a + wx[1] * b + wx[2] * c + wx[3] * d;
            vf along = dx[0] * a + dx[1] * b + dx[2] * c + dx[3] * d;
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
INLINE directions slope_at(const lit_scene *s, __global const uchar *voxels, int4 dims, packet at) {
    directions g = gradient_at(s, voxels, dims, at);
    directions n = {-g.x, -g.y, -fabs(g.z) - s->mx.w};
    return normalised(n);
}

#define FACE_ALL  0.65f /* share of the scan up to which a surface is the scan's own face ... */
#define FACE_NONE 0.8f  /* ... and from which on it is not */

/* The normal of what is drawn: the tissue's own, or that of the scan's face, which is a staircase of voxels.
 * *face: how much it is the latter. */
INLINE directions normal_at(const lit_scene *s, packet at, vf *face) {
    float scale = 1.0f / (float)s->shares.w,
          shift = SHARE_PAD - scale * (LIT_PAD + 0.5f * (float)(s->shares.w - 1));
    packet p = at;
    p.x = at.x * scale + shift;
    p.y = at.y * scale + shift;
    p.z = at.z * scale + shift;
    vf share = blend_fused(fetch(s->scanned, s->shares, p.x, p.y, p.z)) * (1.0f / 255.0f);
    vf f = *face = clamp((FACE_NONE - share) * (1.0f / (FACE_NONE - FACE_ALL)), 0.0f, 1.0f);
    if (lanes_min(f) >= 1.0f) return slope_at(s, s->scanned, s->shares, p);
    directions normal = slope_at(s, s->smooth, s->dims, at);
    if (lanes_max(f) <= 0.0f) return normal;
    directions wide = slope_at(s, s->scanned, s->shares, p);
    normal.x += f * (wide.x - normal.x);
    normal.y += f * (wide.y - normal.y);
    normal.z += f * (wide.z - normal.z);
    return normalised(normal);
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
    STORE(i, at);
    for (int lane = 0; lane < LANES; lane++) depth[lane] = s->map[at[lane]];
    vf d = LOAD(depth);
#else
    vf d = s->map[i];
#endif
    return MASK((d > 0.0f) & (d < INFINITY) & (p.n < d * s->to_samples.x + s->to_samples.y));
}

/* Mean opacities at so many places, MAX_PACKETS at most, 0 .. 1; none outside the volume. */
INLINE void mean_opacities_at(const lit_scene *s, const lit_place *p, int count, vf *value) {
    float block = (float)s->cells.w, shift = 0.5f * (block - 1.0f), scale = 1.0f / block;
    packet at[MAX_PACKETS];
    cell c[MAX_PACKETS];
    for (int i = 0; i < count; i++) {
        packet here = {(p[i].at.x - shift) * scale, (p[i].at.y - shift) * scale, (p[i].at.z - shift) * scale};
        at[i] = here;
    }
    fetch_together(s->opacity, s->cells, at, count, c);
    for (int i = 0; i < count; i++) {
        vf x = at[i].x, y = at[i].y, z = at[i].z;
        vi outside = MASK((min(x, min(y, z)) < -0.5f) | (x > (float)s->cells.x - 0.5f) |
                          (y > (float)s->cells.y - 0.5f) | (z > (float)s->cells.z - 0.5f));
        value[i] = select(blend_fused(c[i]) * (1.0f / 255.0f), (vf)(0.0f), outside);
    }
}

/* Mean opacities, 0 where tissue was removed. */
INLINE void opacities_at(const lit_scene *s, const lit_place *p, int count, vf *value) {
    mean_opacities_at(s, p, count, value);
    if (s->map_dims.x == 0) return;
    for (int i = 0; i < count; i++)
        if (lanes_max(value[i]) > 0.0f) value[i] = select(value[i], (vf)(0.0f), removed(s, p[i]));
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
