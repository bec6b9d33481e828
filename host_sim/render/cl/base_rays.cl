/* SPDX-License-Identifier: MIT */
/*
 * Packets of viewing rays: their positions, trilinear samples, and the steps they may leap.
 *
 * Sample n of the ray through pixel (x, y) stands at voxel index origin + x * dx + y * dy + n * dn (voxel
 * centres at integers). It is computed from n, never summed up, so a leap over empty bricks leads to the very
 * same samples. Within the volume's box (which reaches half a voxel beyond the outer centres, and a
 * thousandth more so that rounding never decides about a sample on its face) intensities beyond the outer
 * centres are those of the nearest voxel; outside the box there is nothing.
 */
#define BOX_HALF_VOXEL 0.501f
/* Voxels by which a packet's bounds are enlarged, to cover the rounding of its rays' own positions. */
#define BOUNDS_MARGIN 0.01f
#define NO_DIRECTION  1e-12f /* voxels per step; below, a ray is parallel to the face */

typedef struct {
    vf x, y, z; /* voxel index of sample 0 */
} packet;

typedef struct {
    float4 low, high; /* smallest and largest voxel index of the packet's samples 0 */
} bounds;

INLINE packet packet_at(int px, int py, float4 origin, float4 dx, float4 dy) {
    vf x = LANE_X + (float)px, y = LANE_Y + (float)py;
    packet p;
    p.x = origin.x + x * dx.x + y * dy.x;
    p.y = origin.y + x * dx.y + y * dy.y;
    p.z = origin.z + x * dx.z + y * dy.z;
    return p;
}

INLINE bounds packet_bounds(packet p) {
    bounds b;
    b.low = (float4)(lanes_min(p.x), lanes_min(p.y), lanes_min(p.z), 0.0f) - BOUNDS_MARGIN;
    b.high = (float4)(lanes_max(p.x), lanes_max(p.y), lanes_max(p.z), 0.0f) + BOUNDS_MARGIN;
    return b;
}

/* Narrows [first, end) to the samples between the faces of one axis. */
INLINE void clip_axis(vf origin, float step, int count, vf *first, vf *end) {
    float low = -BOX_HALF_VOXEL, high = (float)(count - 1) + BOX_HALF_VOXEL;
    if (fabs(step) < NO_DIRECTION) {
        *end = select(*end, (vf)(-1.0f), MASK((origin < low) | (origin > high)));
        return;
    }
    vf a = (low - origin) / step, b = (high - origin) / step;
    *first = max(*first, ceil(min(a, b)));
    *end = min(*end, floor(max(a, b)) + 1.0f);
}

/* Every ray's samples inside the volume's box: [first, end), out of [0, steps). */
INLINE void clip_packet(packet p, float4 dn, int4 dims, vf *first, vf *end) {
    *first = (vf)(0.0f);
    *end = (vf)((float)dims.w);
    clip_axis(p.x, dn.x, dims.x, first, end);
    clip_axis(p.y, dn.y, dims.y, first, end);
    clip_axis(p.z, dn.z, dims.z, first, end);
}

/* A coordinate's lower voxel and its fraction. In the last voxel the fraction is 1 on the one before it. */
INLINE vi split(vf position, int count, vf *fraction) {
    vf p = clamp(position, (vf)(0.0f), (vf)((float)(count - 1)));
    vi i = min(TO_VI(p), (vi)(max(count - 2, 0)));
    *fraction = p - TO_VF(i);
    return i;
}

#if LANES == 16
typedef uint16 vu;
#define TO_VU(v) convert_uint16(v)
#define AS_VU(v) as_uint16(v)
#else
typedef uint vu;
#define TO_VU(v) convert_uint(v)
#define AS_VU(v) as_uint(v)
#endif

/* Two neighbours in x as one 16-bit word; vload2 asks for byte alignment only. */
#define PAIR(p, i) as_ushort(vload2(0, (p) + (i)))
#if LANES == 16
#define PAIRS(p, i)                                                                                          \
    TO_VU((ushort16)(PAIR(p, i.s0), PAIR(p, i.s1), PAIR(p, i.s2), PAIR(p, i.s3), PAIR(p, i.s4),              \
                     PAIR(p, i.s5), PAIR(p, i.s6), PAIR(p, i.s7), PAIR(p, i.s8), PAIR(p, i.s9),              \
                     PAIR(p, i.sa), PAIR(p, i.sb), PAIR(p, i.sc), PAIR(p, i.sd), PAIR(p, i.se),              \
                     PAIR(p, i.sf)))
#else
#define PAIRS(p, i) TO_VU(PAIR(p, i))
#endif

/* A square of voxels: two neighbours in x, and the two at y + 1 as the upper half of a word. */
#define SQUARE(p, row, i)  ((uint)PAIR(p, i) | (uint)PAIR((p) + (row), i) << 16)
#define SQUARES(p, row, i) (PAIRS(p, i) | PAIRS((p) + (row), i) << 16)

#if LANES == 16
/* The squares at `i` and in the next slice, for several packets. Lanes go through memory: a vector made of
 * loaded values costs an insertion for every one of them. That takes time to arrive, so it pays for several
 * packets only. An axis with a single voxel has no second neighbour; its fraction is 0. */
INLINE void fetch_squares(__global const uchar *voxels, int4 dims, const vi *i, int packets, vu *near,
                          vu *far) {
    int row = dims.y > 1 ? dims.x : 0, slice = dims.z > 1 ? dims.x * dims.y : 0;
    int at[MAX_PACKETS * LANES];
    uint near_at[MAX_PACKETS * LANES], far_at[MAX_PACKETS * LANES];
    for (int p = 0; p < packets; p++) STORE(i[p], at + p * LANES);
    for (int lane = 0; lane < packets * LANES; lane++) {
        long o = at[lane];
        near_at[lane] = SQUARE(voxels, row, o);
        far_at[lane] = SQUARE(voxels + slice, row, o);
    }
    for (int p = 0; p < packets; p++) {
        near[p] = LOAD(near_at + p * LANES);
        far[p] = LOAD(far_at + p * LANES);
    }
}
#else
INLINE void fetch_squares(__global const uchar *voxels, int4 dims, const vi *i, int packets, vu *near,
                          vu *far) {
    int row = dims.y > 1 ? dims.x : 0, slice = dims.z > 1 ? dims.x * dims.y : 0;
    for (int p = 0; p < packets; p++) {
        near[p] = SQUARE(voxels, row, i[p]);
        far[p] = SQUARE(voxels + slice, row, i[p]);
    }
}
#endif

/* The two voxels of a square's row, 0 or 1. */
#ifdef __ENDIAN_LITTLE__
#define FIRST_OF(square, row)  TO_VF(((square) >> (16 * (row))) & 0xffu)
#define SECOND_OF(square, row) TO_VF(((square) >> (16 * (row) + 8)) & 0xffu)
#else
#define FIRST_OF(square, row)  TO_VF(((square) >> (16 * (row) + 8)) & 0xffu)
#define SECOND_OF(square, row) TO_VF(((square) >> (16 * (row))) & 0xffu)
#endif

/* The eight voxels around a packet's positions, and the positions' fractions. */
typedef struct {
    vu near, far; /* slices z and z + 1 */
    vf fx, fy, fz;
} cell;

/* Sets the fractions; returns where the eight voxels are. */
INLINE vi place_cell(int4 dims, packet at, cell *c) {
    vi ix = split(at.x, dims.x, &c->fx);
    vi iy = split(at.y, dims.y, &c->fy);
    vi iz = split(at.z, dims.z, &c->fz);
    return (iz * dims.y + iy) * dims.x + ix;
}

INLINE cell fetch(__global const uchar *voxels, int4 dims, vf x, vf y, vf z) {
    cell c;
    packet at = {x, y, z};
    vi i = place_cell(dims, at, &c);
    int row = dims.y > 1 ? dims.x : 0, slice = dims.z > 1 ? dims.x * dims.y : 0;
    c.near = SQUARES(voxels, row, i);
    c.far = SQUARES(voxels + slice, row, i);
    return c;
}

/* Fetches the cells of several packets at once, MAX_PACKETS at most. */
INLINE void fetch_together(__global const uchar *voxels, int4 dims, const packet *at, int packets, cell *c) {
    vi i[MAX_PACKETS];
    vu near[MAX_PACKETS], far[MAX_PACKETS];
    for (int p = 0; p < packets; p++) i[p] = place_cell(dims, at[p], c + p);
    fetch_squares(voxels, dims, i, packets, near, far);
    for (int p = 0; p < packets; p++) {
        c[p].near = near[p];
        c[p].far = far[p];
    }
}

#pragma OPENCL FP_CONTRACT ON
INLINE vf lerp_fused(vf a, vf b, vf f) {
    return a + f * (b - a);
}
#pragma OPENCL FP_CONTRACT OFF

/* `fused`: product and sum are rounded once, where the device has an instruction for that. */
INLINE vf lerp(vf a, vf b, vf f, bool fused) {
    return fused ? lerp_fused(a, b, f) : a + f * (b - a);
}

INLINE vf lerp_row(vu square, int row, vf f, bool fused) {
    return lerp(FIRST_OF(square, row), SECOND_OF(square, row), f, fused);
}

INLINE vf lerp_cell(cell c, bool fused) {
    vf a = lerp_row(c.near, 0, c.fx, fused), b = lerp_row(c.near, 1, c.fx, fused);
    vf d = lerp_row(c.far, 0, c.fx, fused), e = lerp_row(c.far, 1, c.fx, fused);
    return lerp(lerp(a, b, c.fy, fused), lerp(d, e, c.fy, fused), c.fz, fused);
}

/* The trilinear mean of the eight voxels, 0 .. 255; the same bits on every device. */
INLINE vf blend(cell c) {
    return lerp_cell(c, false);
}

/* The same, faster, for the lit look. */
INLINE vf blend_fused(cell c) {
    return lerp_cell(c, true);
}

/* Trilinear intensities of the packet's samples n. */
INLINE vf sample_packet(__global const uchar *voxels, int4 dims, packet p, float4 dn, float n) {
    return blend(fetch(voxels, dims, p.x + n * dn.x, p.y + n * dn.y, p.z + n * dn.z));
}

/* Steps until a coordinate span moving by `step` a sample leaves the bricks low .. high. The outermost bricks
 * have no outer face: coordinates beyond the volume are clamped into them. */
INLINE float steps_inside(float span_low, float span_high, float step, int low, int high, int count) {
    if (step > NO_DIRECTION && high < count - 1)
        return ((float)((high + 1) << BRICK_SHIFT) - span_high) / step;
    if (step < -NO_DIRECTION && low > 0) return (span_low - (float)(low << BRICK_SHIFT)) / -step;
    return MAXFLOAT;
}

INLINE int brick_of(float position, int count) {
    return clamp((int)position >> BRICK_SHIFT, 0, count - 1);
}

/*
 * The largest voxel any ray of the packet can meet at sample n; *run (>= 1) is the number of samples from n
 * on for which that holds. All rays of a packet share the direction, so their bounds just move along.
 */
INLINE int packet_maximum(__global const uchar *grid, int4 bricks, bounds b, float4 dn, int n, int *run) {
    float4 low = b.low + (float)n * dn, high = b.high + (float)n * dn;
    int x0 = brick_of(low.x, bricks.x), x1 = brick_of(high.x, bricks.x);
    int y0 = brick_of(low.y, bricks.y), y1 = brick_of(high.y, bricks.y);
    int z0 = brick_of(low.z, bricks.z), z1 = brick_of(high.z, bricks.z);
    int largest = 0;
    for (int z = z0; z <= z1; z++) {
        for (int y = y0; y <= y1; y++) {
            for (int x = x0; x <= x1; x++) {
                largest = max(largest, (int)grid[(z * bricks.y + y) * bricks.x + x]);
            }
        }
    }
    float steps = min(min(steps_inside(low.x, high.x, dn.x, x0, x1, bricks.x),
                          steps_inside(low.y, high.y, dn.y, y0, y1, bricks.y)),
                      steps_inside(low.z, high.z, dn.z, z0, z1, bricks.z));
    /* Sample n itself is inside; sample n + k is as long as k < steps. */
    *run = (int)clamp(ceil(steps), 1.0f, 65536.0f);
    return largest;
}
