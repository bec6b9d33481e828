/* SPDX-License-Identifier: MIT */
/*
 * The scanned range of every ray of the low-resolution volume (sv_frame.scanned): from the first to the last
 * voxel that is not 0, since 0 means "not scanned" and nothing else (host_sim/volume/volume.h). A work item
 * takes one row of rays; it walks each from the front to the first scanned voxel, and from the back to the
 * last one, so it reads little more than what was not scanned.
 *
 * layout: tiles_x, tile_w, tile_h, row_pitch; size: width, slices, slices of a full slab; slab i begins at
 * i * stride bytes.
 */
INLINE int is_scanned(__global const uchar *slabs, int4 layout, int4 size, ulong stride, int x, int y,
                      int z) {
    int slab = z / size.z, slice = z % size.z;
    size_t row = (size_t)(slice / layout.x) * layout.z + y;
    return slabs[slab * stride + row * layout.w + (slice % layout.x) * layout.y + x] != 0;
}

__kernel void scanned_rays(__global const uchar *slabs, int4 layout, int4 size, ulong stride,
                           __global ushort2 *ranges) {
    int y = (int)get_global_id(0);
    __global ushort2 *row = ranges + (size_t)y * size.x;
    for (int x = 0; x < size.x; x++) {
        int first = 0, end = size.y;
        while (first < end && !is_scanned(slabs, layout, size, stride, x, y, first)) first++;
        while (end > first && !is_scanned(slabs, layout, size, stride, x, y, end - 1)) end--;
        row[x] = (ushort2)((ushort)first, (ushort)end);
    }
}
