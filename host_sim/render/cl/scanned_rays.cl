/* SPDX-License-Identifier: MIT */
/*
 * The scanned range of every ray of the low-resolution volume (sv_frame.scanned): from the first to the last
 * voxel that is not 0, since 0 means "not scanned" and nothing else (host_sim/volume/volume.h). A work item
 * takes a packet of LANES rays of a row; it walks from the front until all of them have met a scanned voxel,
 * and from the back until all have met their last one, so it reads little more than what was not scanned.
 *
 * layout: tiles_x, tile_w, tile_h, row_pitch; size: width, slices, slices of a full slab; slab i begins at
 * i * stride bytes.
 */

/* The `count` voxels from (x, y) on in slice z that were scanned, as a mask; lanes behind them count as such.
 */
INLINE vi scanned_lanes(__global const uchar *slabs, int4 layout, int4 size, ulong stride, int x, int y,
                        int z, int count) {
    int slab = z / size.z, slice = z % size.z;
    size_t row = (size_t)(slice / layout.x) * layout.z + y;
    __global const uchar *at = slabs + slab * stride + row * layout.w + (slice % layout.x) * layout.y + x;
    if (count == LANES) return MASK(TO_VI(LOAD(at)) != 0);
    int lanes[LANES];
    for (int i = 0; i < LANES; i++) lanes[i] = 1;
    for (int i = 0; i < count; i++) lanes[i] = at[i];
    return MASK(LOAD(lanes) != 0);
}

__kernel void scanned_rays(__global const uchar *slabs, int4 layout, int4 size, ulong stride,
                           __global ushort2 *ranges) {
    int x = (int)get_global_id(0) * LANES, y = (int)get_global_id(1);
    int count = min(size.x - x, LANES), z, firsts[LANES], ends[LANES];
    vi first = (vi)(0), end = (vi)(size.y), open = (vi)(-1);
    for (z = 0; z < size.y && !all_lanes(~open); z++) {
        open &= ~scanned_lanes(slabs, layout, size, stride, x, y, z, count);
        first -= open; /* a mask is -1 */
    }
    open = (vi)(-1);
    for (z = size.y - 1; z >= 0 && !all_lanes(~open); z--) {
        open &= ~scanned_lanes(slabs, layout, size, stride, x, y, z, count);
        end += open;
    }
    end = max(end, first); /* nothing was scanned: both ends are that of the volume */
    STORE(first, firsts);
    STORE(end, ends);
    __global ushort2 *to = ranges + (size_t)y * size.x + x;
    for (int i = 0; i < count; i++) to[i] = (ushort2)((ushort)firsts[i], (ushort)ends[i]);
}
