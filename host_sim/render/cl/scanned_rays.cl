/* SPDX-License-Identifier: MIT */
/*
 * The scanned range of every ray of the low-resolution volume (sv_frame.scanned): from the first to the last
 * voxel that is not 0, since 0 means "not scanned" and nothing else (host_sim/volume/volume.h). A work item
 * takes a packet of LANES rays of a row; it walks from the front of the source's box until all of them have
 * met a scanned voxel, and from its back until all have met their last one, so it reads little more than what
 * was not scanned inside the box.
 *
 * layout: tiles_x, tile_w, tile_h, row_pitch; size: width, slices, slices of a full slab; slab i begins at
 * i * stride bytes. Voxel (x, y, z) has its first corner at source index origin + x * dx + y * dy + z * dz,
 * and the next ones a dx, dy, dz further; dims: source voxels. Without steps all slices are searched.
 */
#define FACE_MARGIN  0.51f /* voxels from the outer centres to a face of the box, and some for rounding */
#define SLICE_MARGIN 1.0f  /* more for rounding */
#define MIN_STEP     1e-6f /* voxels a slice; below, rays are parallel to the face */

/* Narrows the slices [range.x, range.y) to those that lie between the faces of one axis. low, high: source
 * index of the packet at slice 0; step: voxels a slice. */
INLINE float2 between_faces(float2 range, float low, float high, float step, int count) {
    float near = -FACE_MARGIN, far = (float)(count - 1) + FACE_MARGIN;
    if (fabs(step) < MIN_STEP) return high < near || low > far ? (float2)(0.0f) : range;
    float a = (step > 0.0f ? near - high : far - low) / step,
          b = (step > 0.0f ? far - low : near - high) / step;
    return (float2)(max(range.x, floor(a) - SLICE_MARGIN), min(range.y, ceil(b) + SLICE_MARGIN));
}

/* Slices outside of which nothing of the packet at (x, y) lies in the source's box. */
INLINE int2 slices_in_box(int x, int y, int count, int slices, int4 dims, float4 origin, float4 dx, float4 dy,
                          float4 dz) {
    float4 corner = origin + (float)x * dx + (float)y * dy, zero = (float4)(0.0f);
    float4 low = corner + min((float)count * dx, zero) + min(dy, zero) + min(dz, zero);
    float4 high = corner + max((float)count * dx, zero) + max(dy, zero) + max(dz, zero);
    float2 range = (float2)(0.0f, (float)slices);
    range = between_faces(range, low.x, high.x, dz.x, dims.x);
    range = between_faces(range, low.y, high.y, dz.y, dims.y);
    range = between_faces(range, low.z, high.z, dz.z, dims.z);
    int first = (int)min(range.x, (float)slices);
    return (int2)(first, max((int)range.y, first));
}

/* A slice of the slabs: its place in its slab, its tile's place in the texture, and where the slab begins. */
typedef struct {
    int slice, column, row;
    ulong slab;
} slice_place;

INLINE slice_place place_of(int z, int4 layout, int4 size, ulong stride) {
    int slice = z % size.z;
    slice_place p = {slice, slice % layout.x, slice / layout.x * layout.z, (ulong)(z / size.z) * stride};
    return p;
}

/* One slice on; without the divisions, which cost more than all the rest. */
INLINE void step_back(slice_place *p, int4 layout, int4 size, ulong stride) {
    p->slice++;
    if (++p->column == layout.x) {
        p->column = 0;
        p->row += layout.z;
    }
    if (p->slice == size.z) {
        p->slice = p->column = p->row = 0;
        p->slab += stride;
    }
}

INLINE void step_front(slice_place *p, int4 layout, int4 size, ulong stride) {
    if (p->slice == 0) {
        p->slice = size.z - 1;
        p->column = p->slice % layout.x;
        p->row = p->slice / layout.x * layout.z;
        p->slab -= stride;
        return;
    }
    p->slice--;
    if (p->column-- == 0) {
        p->column = layout.x - 1;
        p->row -= layout.z;
    }
}

/* The voxel (x, y) of a slice. */
INLINE __global const uchar *voxel_at(__global const uchar *slabs, int4 layout, const slice_place *p, int x,
                                      int y) {
    return slabs + p->slab + (size_t)(p->row + y) * layout.w + (size_t)p->column * layout.y + x;
}

/* Whether none of LANES voxels was scanned; quicker than a mask, and most are like that behind a turned
 * fan. */
INLINE int none_scanned(__global const uchar *at) {
#if LANES == 16
    ulong2 words = as_ulong2(LOAD(at));
    return (words.x | words.y) == 0;
#else
    return *at == 0;
#endif
}

/* The `count` voxels that were scanned, as a mask; lanes behind them count as such. */
INLINE vi scanned_lanes(__global const uchar *at, int count) {
    if (count == LANES) return MASK(TO_VI(LOAD(at)) != 0);
    int lanes[LANES];
    for (int i = 0; i < LANES; i++) lanes[i] = 1;
    for (int i = 0; i < count; i++) lanes[i] = at[i];
    return MASK(LOAD(lanes) != 0);
}

__kernel void scanned_rays(__global const uchar *slabs, int4 layout, int4 size, ulong stride, int4 dims,
                           float4 origin, float4 dx, float4 dy, float4 dz, __global ushort2 *ranges) {
    int x = (int)get_global_id(0) * LANES, y = (int)get_global_id(1);
    int count = min(size.x - x, LANES), firsts[LANES], ends[LANES];
    int2 box = slices_in_box(x, y, count, size.y, dims, origin, dx, dy, dz);
    int z = box.x;
    slice_place place = place_of(z, layout, size, stride);
    for (; z < box.y && count == LANES && none_scanned(voxel_at(slabs, layout, &place, x, y)); z++)
        step_back(&place, layout, size, stride);
    vi first = (vi)(z), open = (vi)(-1);
    for (; z < box.y && !all_lanes(~open); z++) {
        open &= ~scanned_lanes(voxel_at(slabs, layout, &place, x, y), count);
        first -= open; /* a mask is -1 */
        step_back(&place, layout, size, stride);
    }
    first = select(first, (vi)(size.y), open); /* nothing was scanned: both ends are that of the volume */
    z = box.y;
    place = place_of(max(z - 1, 0), layout, size, stride);
    for (; z > box.x && count == LANES && none_scanned(voxel_at(slabs, layout, &place, x, y)); z--)
        step_front(&place, layout, size, stride);
    vi end = (vi)(z);
    open = (vi)(-1);
    for (; z > box.x && !all_lanes(~open); z--) {
        open &= ~scanned_lanes(voxel_at(slabs, layout, &place, x, y), count);
        end += open;
        step_front(&place, layout, size, stride);
    }
    end = max(end, first);
    STORE(first, firsts);
    STORE(end, ends);
    __global ushort2 *to = ranges + (size_t)y * size.x + x;
    for (int i = 0; i < count; i++) to[i] = (ushort2)((ushort)firsts[i], (ushort)ends[i]);
}
