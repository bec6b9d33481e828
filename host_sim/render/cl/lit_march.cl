/* SPDX-License-Identifier: MIT */
/*
 * A packet's way through the smoothed volume: optical depth, integrated exactly over intensities that are
 * linear from sample to sample, and where it makes a surface. Two stretches are kept apart: what lies before
 * the clipping surface and is ghosted (the veil), and what lies behind it (the surface).
 */
#define SURFACE_DEPTH 0.6931472f /* ln 2: an opacity of a half */
#define LOOK_BACK     2          /* samples before the surface among which its edge is sought ... */
#define LOOK_AHEAD    3          /* ... and behind it */
#define LOOK_FAR      5          /* one more, for rays that graze a surface */
#define LOOKS         (LOOK_BACK + LOOK_AHEAD + 2) /* of them all: between MAX_PACKETS and twice that */
#define HALVINGS      6                            /* of a step */

/* Opacity above T_L's, on a scale where T_H is 1; not limited. */
INLINE vf ramp_of(vf value, float4 window) {
    return (value - window.x) * window.y;
}

INLINE vf sample_smooth(__global const uchar *smooth, int4 dims, packet p, float4 dn, float n) {
    return blend_fused(fetch(smooth, dims, p.x + n * dn.x, p.y + n * dn.y, p.z + n * dn.z));
}

/* The mean of clamp(y, 0, 1) while y runs from a to b. */
INLINE vf mean_opacity(vf a, vf b) {
    vf ca = clamp(a, 0.0f, 1.0f), cb = clamp(b, 0.0f, 1.0f), d = b - a;
    vf whole = cb * (b - 0.5f * cb) - ca * (a - 0.5f * ca);
    return select(whole / d, 0.5f * (ca + cb), MASK(fabs(d) < 1e-3f));
}

/* What a packet has met. */
typedef struct {
    vf depth;                    /* optical depth behind the clipping surface */
    vf begin, first, last, rest; /* the step that made the surface: from where, its two ramps, what lacked */
    vi found;                    /* -1: there is such a step */
    vf thickest, at;             /* the thickest step, and its middle: for rays without a surface */
    vf cut;                      /* opacity in the clipping surface itself */
    vf veil, veil_thickest, veil_at; /* the same of what is ghosted */
} met;

/* Where a ray's ghosting begins, where it is over, and 1 / the way between (0: a hard cut). */
typedef struct {
    vf rise, full, slope;
} ghost_range;

INLINE ghost_range ghost_range_of(__global const float *map, __global const float *confidence, int4 map_dims,
                                  float4 to_map, float4 to_samples, int px, int py) {
    ghost_range range = {(vf)(UNCLIPPED), (vf)(UNCLIPPED), (vf)(0.0f)};
    if (map_dims.x == 0) return range;
    float rise[LANES], full[LANES], slope[LANES];
    for (int lane = 0; lane < LANES; lane++) {
        float x = ((float)(px + lane % PACKET_W) + 0.5f) * to_map.x + to_map.z - 0.5f;
        float y = ((float)(py + lane / PACKET_W) + 0.5f) * to_map.y + to_map.w - 0.5f;
        float depth = map_at(map, map_dims.x, map_dims.y, x, y), width = 0.0f;
        if (to_samples.z > 0.0f) width = 1.0f / to_samples.z;
        if (to_samples.w > 0.0f)
            width += to_samples.w * (1.0f - map_at(confidence, map_dims.x, map_dims.y, x, y));
        bool clips = depth > 0.0f && depth < INFINITY;
        full[lane] = clips ? depth * to_samples.x + to_samples.y : UNCLIPPED;
        rise[lane] = clips ? full[lane] - width : UNCLIPPED;
        slope[lane] = width > 0.0f ? 1.0f / width : 0.0f;
    }
    range.rise = LOAD(rise);
    range.full = LOAD(full);
    range.slope = LOAD(slope);
    return range;
}

/* The step from sample a to a + 1, whose ramps are y0 and y1. */
INLINE void take_step(met *m, ghost_range ghost, float a, vf y0, vf y1, float thickness) {
    vf part = clamp(ghost.full - a, 0.0f, 1.0f);
    vf y = y0 + part * (y1 - y0);
    vf depth = thickness * (1.0f - part) * mean_opacity(y, y1);
    vi now = ~m->found & MASK(m->depth + depth >= SURFACE_DEPTH);
    m->begin = select(m->begin, a + part, now);
    m->first = select(m->first, y, now);
    m->last = select(m->last, y1, now);
    m->rest = select(m->rest, SURFACE_DEPTH - m->depth, now);
    m->found |= now;
    vi thick = MASK(depth > m->thickest);
    m->thickest = select(m->thickest, depth, thick);
    m->at = select(m->at, a + part + 0.5f * (1.0f - part), thick);
    m->depth += depth;
    m->cut = select(m->cut, clamp(y, 0.0f, 1.0f), MASK((ghost.full >= a) & (ghost.full < a + 1.0f)));
}

/* Adds the part of the step that is ghosted. */
INLINE void take_veil(met *m, ghost_range ghost, float a, vf y0, vf y1, float thickness) {
    vf part = clamp(ghost.full - a, 0.0f, 1.0f);
    vf factor = clamp((a + 0.5f * part - ghost.rise) * ghost.slope, 0.0f, 1.0f);
    vf depth = thickness * part * factor * mean_opacity(y0, y0 + part * (y1 - y0));
    vi thick = MASK(depth > m->veil_thickest);
    m->veil_thickest = select(m->veil_thickest, depth, thick);
    m->veil_at = select(m->veil_at, (vf)(a + 0.5f), thick);
    m->veil += depth;
}

#define MARCH_AHEAD 4 /* samples: a cache that is slow has answered by then */

/* Asks for what the packet reads of the volume at sample n: rows of the slice that rays come to then. */
INLINE void ask_for_sample(__global const uchar *smooth, int4 dims, packet p, float4 dn, float n) {
#if LANES == 16
    int4 x = convert_int4(p.x.s048c + n * dn.x), y = convert_int4(p.y.s048c + n * dn.y),
         z = convert_int4(p.z.s048c + n * dn.z);
    int4 i = ((z + (dn.z > 0.0f ? 1 : 0)) * dims.y + y) * dims.x + x;
    fetch_ahead(smooth, i.s0);
    fetch_ahead(smooth, i.s1);
    fetch_ahead(smooth, i.s2);
    fetch_ahead(smooth, i.s3);
    fetch_ahead(smooth, i.s3 + dims.x);
#endif
}

/* Walks from sample `n` until every ray has its surface or is through. */
INLINE met march(__global const uchar *smooth, int4 dims, __global const uchar *grid, int4 bricks, packet p,
                 float4 dn, ghost_range ghost, float4 window, bool veiled, int n, int end) {
    met m = {(vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vi)(0),
             (vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vf)(0.0f), (vf)(0.0f)};
    bounds b = packet_bounds(p);
    bool known = false; /* y0 is the ramp at sample n - 1 */
    vf y0 = (vf)(0.0f);
    n = max(n, 1);
    while (n < end) {
        int run;
        bool clear = packet_maximum(grid, bricks, b, dn, n, &run) <= bricks.w;
        if (clear && !known) {
            n += run;
            continue;
        }
        if (!known) y0 = ramp_of(sample_smooth(smooth, dims, p, dn, (float)(n - 1)), window);
        known = !clear;
        int stop =
            clear ? n + 1 : min(n + run, end); /* a clear brick's first sample ends the step before it */
        for (; n < stop; n++) {
            ask_for_sample(smooth, dims, p, dn, (float)(n + MARCH_AHEAD));
            vf y1 = ramp_of(sample_smooth(smooth, dims, p, dn, (float)n), window);
            if (veiled) take_veil(&m, ghost, (float)(n - 1), y0, y1, window.z);
            take_step(&m, ghost, (float)(n - 1), y0, y1, window.z);
            y0 = y1;
            if (all_lanes(m.found)) return m;
        }
    }
    return m;
}

/* Where the optical depth reaches that of a surface, within its step. */
INLINE vf surface_of(met m, float thickness) {
    vf length = 1.0f - (m.begin - floor(m.begin)), low = (vf)(0.0f), high = (vf)(1.0f);
    for (int i = 0; i < HALVINGS; i++) {
        vf half_way = 0.5f * (low + high);
        vf depth =
            thickness * length * half_way * mean_opacity(m.first, m.first + half_way * (m.last - m.first));
        vi beyond = MASK(depth >= m.rest);
        high = select(high, half_way, beyond);
        low = select(half_way, low, beyond);
    }
    return m.begin + length * 0.5f * (low + high);
}

/*
 * The edge: where the intensity first reaches half of its maximum around the surface. There the gradient is
 * steepest, and the place does not depend on how bright the tissue is and how wide the smoothing.
 */
INLINE vf edge_of(__global const uchar *smooth, int4 dims, packet p, float4 dn, vf surface, vf full,
                  float4 window) {
    vf value[LOOKS], where[LOOKS], maximum = (vf)(0.0f);
    packet at[LOOKS];
    cell c[LOOKS];
    for (int i = 0; i < LOOKS; i++) {
        vf n = surface + (float)(i < LOOKS - 1 ? i - LOOK_BACK : LOOK_FAR);
        if (i < LOOKS - 1) n = max(max(n, full), (vf)(0.0f));
        packet here = {p.x + n * dn.x, p.y + n * dn.y, p.z + n * dn.z};
        where[i] = n;
        at[i] = here;
    }
    fetch_together(smooth, dims, at, MAX_PACKETS, c);
    fetch_together(smooth, dims, at + MAX_PACKETS, LOOKS - MAX_PACKETS, c + MAX_PACKETS);
    for (int i = 0; i < LOOKS; i++) {
        value[i] = blend_fused(c[i]);
        maximum = max(maximum, value[i]);
    }
    vf level = min(0.5f * maximum, window.x + 1.0f / window.y), edge = where[0];
    vi open = MASK(value[0] < level);
    for (int i = 0; i < LOOK_BACK + LOOK_AHEAD; i++) {
        vi here = open & MASK(value[i + 1] >= level);
        vf part = (level - value[i]) / max(value[i + 1] - value[i], 1e-6f);
        edge = select(edge, where[i] + part * (where[i + 1] - where[i]), here);
        open &= ~here;
    }
    return edge;
}
