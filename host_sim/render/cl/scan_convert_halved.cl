/* SPDX-License-Identifier: MIT */
/*
 * Scan conversion from the halved volume (cl/halve.cl): trilinear samples in integers, so that every device
 * makes the same bytes (host_sim/render/scan_convert.h defines the result). A halved voxel is a mean of
 * eight, so one sample does what some twenty would do in the source, from an eighth of the bytes. At the
 * edge of what was scanned the nearest voxels of the source count, as in convert_nearest.
 */
#define WEIGHT_BITS 8     /* of a position between two voxels: a sample's weights add up to 1 << 8 */
#define BLOCK       LANES /* edge of what a work item of convert_halved makes; the host's (scan_convert.c) */

/* Where between eight voxels a packet's positions lie: 0 .. 1 << WEIGHT_BITS. */
typedef struct {
    vi x, y, z;
} fractions;

/* A position's lower voxel and its fraction; in the outer half voxel those of the nearest one. */
INLINE vi split_fixed(vi position, int count, int bits, vi *fraction) {
    vi p = clamp(position, (vi)(0), (vi)((count - 1) << bits)) + (1 << (bits - WEIGHT_BITS - 1));
    vi i = min(p >> bits, (vi)(max(count - 2, 0)));
    *fraction = (p - (i << bits)) >> (bits - WEIGHT_BITS);
    return i;
}

/* Where the eight voxels lie. */
INLINE vi place_fixed(int4 dims, vi x, vi y, vi z, int bits, fractions *f) {
    vi ix = split_fixed(x, dims.x, bits, &f->x);
    vi iy = split_fixed(y, dims.y, bits, &f->y);
    vi iz = split_fixed(z, dims.z, bits, &f->z);
    return iz * (dims.y * dims.x) + iy * dims.x + ix;
}

/* Finds voxels and fractions as place_fixed does, for positions all of which lie between voxels. */
INLINE vi place_inside(int4 dims, vi x, vi y, vi z, int bits, fractions *f) {
    int half_a_part = 1 << (bits - WEIGHT_BITS - 1), parts = (1 << WEIGHT_BITS) - 1;
    x += half_a_part;
    y += half_a_part;
    z += half_a_part;
    f->x = (x >> (bits - WEIGHT_BITS)) & parts;
    f->y = (y >> (bits - WEIGHT_BITS)) & parts;
    f->z = (z >> (bits - WEIGHT_BITS)) & parts;
    return (z >> bits) * (dims.y * dims.x) + (y >> bits) * dims.x + (x >> bits);
}

/* RUN: packets made together; a sample is a long chain of steps, and so those of several packets overlap. */
#if LANES == 16
#define RUN MAX_PACKETS
#else
#define RUN 1
#endif

#define EVEN_BYTES 0x00ff00ffu

/* The mean of a square, times 1 << WEIGHT_BITS: along both rows at once, then between them. */
INLINE vi mix_square(vu square, vi fx, vi fy) {
#ifdef __ENDIAN_LITTLE__
    vu first = square & EVEN_BYTES, second = (square >> 8) & EVEN_BYTES;
#else
    vu second = square & EVEN_BYTES, first = (square >> 8) & EVEN_BYTES;
#endif
    /* What the upper half lends the lower one, it gets back. */
    vu rows = (first << WEIGHT_BITS) + (second - first) * AS_VU(fx);
    vu upper = rows & 0xffffu, lower = rows >> 16;
    vu both = (upper << WEIGHT_BITS) + (lower - upper) * AS_VU(fy);
    return TO_VI((both + (1u << (WEIGHT_BITS - 1))) >> WEIGHT_BITS);
}

/* The trilinear mean of the eight voxels, times 1 << WEIGHT_BITS. */
INLINE vi blend_fixed(vu near, vu far, fractions f) {
    vi a = mix_square(near, f.x, f.y), b = mix_square(far, f.x, f.y);
    return ((a << WEIGHT_BITS) + (b - a) * f.z + (1 << (WEIGHT_BITS - 1))) >> WEIGHT_BITS;
}

/* What a packet's samples come to: their sum, times 1 << WEIGHT_BITS; -1 in lanes all of whose samples lie
 * between whole voxels, or in those none of whose samples lies beside anything scanned. */
typedef struct {
    vi sum, whole, empty;
} fixed_sum;

INLINE void add_sample(fixed_sum *out, vu near, vu far, fractions f, vi in) {
    /* A byte below HALVED_MIN borrows. */
    vu low = ((near - 0x02020202u) & ~near) | ((far - 0x02020202u) & ~far);
    out->whole &= in & MASK((low & 0x80808080u) == 0);
    out->empty &= ~in | MASK((near | far) == 0);
    out->sum += blend_fixed(near, far, f);
}

/* What a conversion works with; positions are those of the halved volume's voxels. */
typedef struct {
    __global const uchar *halved, *voxels;
    int4 half_dims, dims;
    int4 face, limit; /* of the volume: its near and its far faces */
    int4 inner;       /* from 0 to here all lies between voxels */
    int4 grid;
    lattice l;
    int samples; /* of a voxel */
    int shift;   /* log2 of the sum of their weights; -1: it is no power of two */
} halved_job;

/* Places of `packets` packets' samples, one slice behind the other. `inside`: all lie between voxels. */
INLINE void place_run(const halved_job *job, vi x, vi y, vi z, int4 at, bool inside, int packets, vi *place,
                      vi *in, fractions *f) {
    int4 face = job->face, limit = job->limit;
    for (int r = 0; r < packets; r++, at += job->grid.z * job->l.dz) {
        vi px = x + at.x, py = y + at.y, pz = z + at.z;
        in[r] = (vi)(-1);
        if (inside) {
            place[r] = place_inside(job->half_dims, px, py, pz, job->l.bits, f + r);
            continue;
        }
        in[r] = MASK((px >= face.x) & (px <= limit.x) & (py >= face.y) & (py <= limit.y) & (pz >= face.z) &
                     (pz <= limit.z));
        place[r] = place_fixed(job->half_dims, px, py, pz, job->l.bits, f + r);
    }
}

/* What those packets come to; `start`: the first sample of the first one. */
INLINE void gather_halved(const halved_job *job, int4 start, bool inside, int packets, fixed_sum *out) {
    const lattice l = job->l;
    int4 grid = job->grid;
    vi place[RUN], in[RUN];
    fractions f[RUN];
    vu near[RUN], far[RUN];
    vi lane_x = TO_VI(LANE_X) * grid.x, lane_y = TO_VI(LANE_Y) * grid.y;
    vi x = lane_x * l.dx.x + lane_y * l.dy.x, y = lane_x * l.dx.y + lane_y * l.dy.y,
       z = lane_x * l.dx.z + lane_y * l.dy.z;
    fixed_sum nothing = {(vi)(0), (vi)(-1), (vi)(-1)};
    for (int r = 0; r < packets; r++) out[r] = nothing;
    for (int k = 0; k < grid.z; k++) {
        for (int j = 0; j < grid.y; j++) {
            int4 at = start + j * l.dy + k * l.dz;
            for (int i = 0; i < grid.x; i++, at += l.dx) {
                place_run(job, x, y, z, at, inside, packets, place, in, f);
                fetch_squares(job->halved, job->half_dims, place, packets, near, far);
                for (int r = 0; r < packets; r++) add_sample(out + r, near[r], far[r], f[r], in[r]);
            }
        }
    }
}

/* The packet's mean from the source's nearest voxels: two samples an axis where `halved` has one. */
INLINE vi nearest_mean(__global const uchar *voxels, int4 dims, int4 grid, lattice l, int4 start) {
    int4 first = 2 * start + (1 << l.bits) - (l.dx + l.dy + l.dz) / 2;
    vi packed = gather_nearest(voxels, dims, 2 * grid, l, first, 1);
    return mean_of(packed, 8 * grid.x * grid.y * grid.z);
}

/* A packet's voxels from its samples. */
INLINE vi mean_of_samples(const halved_job *job, fixed_sum s, int4 start) {
    vi decided = s.whole | s.empty, mean;
    if (job->shift >= 0)
        mean = (s.sum + (1 << (job->shift - 1))) >> job->shift;
    else
        mean = rounded_mean(s.sum, (vi)(job->samples << WEIGHT_BITS));
    mean &= s.whole;
    if (all_lanes(decided)) return mean;
    return select(nearest_mean(job->voxels, job->dims, job->grid, job->l, start), mean, decided);
}

/* The slab that voxels are written to. */
typedef struct {
    __global uchar *slab;
    int4 layout, size;
} slab_target;

INLINE void convert_run(const halved_job *job, slab_target to, place at, int slice, int4 start, bool inside,
                        int packets) {
    fixed_sum s[RUN];
    gather_halved(job, start, inside, packets, s);
    for (int r = 0; r < packets; r++, start += job->grid.z * job->l.dz)
        store_packet(to.slab, to.layout, to.size, at, slice + r, mean_of_samples(job, s[r], start));
}

/* Least and largest position of a box' samples. */
typedef struct {
    int4 low, high;
} reach;

INLINE int4 start_of(const halved_job *job, place at) {
    const lattice *l = &job->l;
    return l->origin + at.x * job->grid.x * l->dx + at.y * job->grid.y * l->dy + at.z * job->grid.z * l->dz;
}

INLINE reach reach_of(const halved_job *job, int4 start, int width, int height, int slices) {
    int4 xs = (width * job->grid.x - 1) * job->l.dx, ys = (height * job->grid.y - 1) * job->l.dy,
         zs = (slices * job->grid.z - 1) * job->l.dz;
    reach r = {start + min(xs, 0) + min(ys, 0) + min(zs, 0), start + max(xs, 0) + max(ys, 0) + max(zs, 0)};
    return r;
}

INLINE bool is_outside(const halved_job *job, reach r) {
    return any(((r.high < job->face) | (r.low > job->limit)).xyz);
}

INLINE bool is_inside(const halved_job *job, reach r) {
    return all(((r.low >= 0) & (r.high < job->inner)).xyz);
}

/* A slice of a block that lies outside the volume. */
INLINE void clear_slice(slab_target to, place block, int slice) {
    __global uchar *row = tile_of(to.slab, to.layout, slice) + (size_t)block.y * to.layout.w + block.x;
    int width = min(BLOCK, to.size.x - block.x), end = min(block.y + BLOCK, to.size.y);
    for (int y = block.y; y < end; y++, row += to.layout.w) {
#if LANES == 16
        if (width == BLOCK) {
            store_bytes((uchar16)(0), row);
            continue;
        }
#endif
        for (int x = 0; x < width; x++) row[x] = 0;
    }
}

/* A packet in so many slices, RUN at most. */
INLINE void convert_column(const halved_job *job, slab_target to, place at, int slice, int slices) {
    int4 start = start_of(job, at);
    reach r = reach_of(job, start, PACKET_W, PACKET_H, slices);
    if (is_outside(job, r)) {
        for (int i = 0; i < slices; i++) store_packet(to.slab, to.layout, to.size, at, slice + i, (vi)(0));
    } else if (slices < RUN) {
        for (int i = 0; i < slices; i++, start += job->grid.z * job->l.dz)
            convert_run(job, to, at, slice + i, start, false, 1);
    } else if (is_inside(job, r)) {
        convert_run(job, to, at, slice, start, true, RUN);
    } else {
        convert_run(job, to, at, slice, start, false, RUN);
    }
}

/*
 * Arguments as convert_nearest, with the halved volume before them and the slab's slices after size;
 * positions are those of the halved volume's voxels. global: blocks in x, slices, y. What a block reads fits
 * the first-level cache, however the camera is turned; one outside the volume is only cleared: of a turned
 * camera's box that is more than half.
 */
WIDE __kernel void convert_halved(__global const uchar *halved, int4 half_dims, __global const uchar *voxels,
                                  int4 dims, int4 grid, int4 origin, int4 dx, int4 dy, int4 dz, int4 size,
                                  int slices, int4 layout, __global uchar *slab, ulong offset) {
    int first = (int)get_global_id(1) * BLOCK, end = min(first + BLOCK, slices), bits = size.w;
    place block = {(int)get_global_id(0) * BLOCK, (int)get_global_id(2) * BLOCK, size.z + first};
    int x_end = min(block.x + BLOCK, size.x), y_end = min(block.y + BLOCK, size.y);
    slab_target to = {slab + offset, layout, size};
    halved_job job = {halved,
                      voxels,
                      half_dims,
                      dims,
                      (int4)(-(1 << (bits - 1))),
                      (dims - 1) << (bits - 1),
                      ((half_dims - 1) << bits) - (1 << (bits - WEIGHT_BITS)),
                      grid,
                      {origin, dx, dy, dz, bits},
                      grid.x * grid.y * grid.z,
                      -1};
    if ((job.samples & (job.samples - 1)) == 0) job.shift = WEIGHT_BITS + 31 - clz(job.samples);
    reach r = reach_of(&job, start_of(&job, block), x_end - block.x, y_end - block.y, end - first);
    if (is_outside(&job, r)) {
        for (int slice = first; slice < end; slice++) clear_slice(to, block, slice);
        return;
    }
    for (int slice = first; slice < end; slice += RUN) {
        place at = {block.x, block.y, size.z + slice};
        for (at.y = block.y; at.y < y_end; at.y += PACKET_H)
            for (at.x = block.x; at.x < x_end; at.x += PACKET_W)
                convert_column(&job, to, at, slice, min(RUN, end - slice));
    }
}
