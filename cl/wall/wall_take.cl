/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, while the slabs come: every voxel is read once and kept, 0 where it was not scanned;
 * and the scanned range of every ray.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

static uchar16 bytes16_of(short16 mask) {
    return as_uchar16(convert_char16(mask));
}

static short16 words16_of(uchar16 mask) {
    return convert_short16(as_char16(mask));
}

#define NEVER 32767 /* first slice of a ray that was not scanned */

/* Row y of ray ranges before the first slab: all that can be said without the voxels. Behind the last ray:
 * never. */
static void begin_ranges(const sv_wall_layout *l, bool padded, bool ranged, uint scanned_width,
                         __global const ushort *scanned, __global ushort *rays, uint y) {
    __global ushort *first = (__global ushort *)ray_row(rays, l, RAY_FIRST, y);
    __global ushort *end = (__global ushort *)ray_row(rays, l, RAY_END, y);
    __global const ushort *from = scanned + (size_t)y * scanned_width;
    __global const ushort *to = from + (size_t)l->height * scanned_width;
    for (uint x = 0; x < padded_width_of(l); x++) {
        first[x] = NEVER;
        end[x] = 0;
        if (padded || x >= l->width || (ranged && from[x] >= to[x])) continue;
        first[x] = ranged ? from[x] : (ushort)0;
        end[x] = ranged ? to[x] : (ushort)l->slices;
    }
}

/* One work item per row of rays. `ranged`: `scanned` has planes of the rays' ranges. With a padding value the
 * range of a ray goes from its first voxel of another value to its last. */
__kernel void wall_take(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint padding,
                        uint ranged, uint scanned_width, __global const ushort *restrict scanned,
                        sv_wall_layout l, __global uchar16 *restrict voxels, __global ushort *restrict rays) {
    const uint y = (uint)get_global_id(0), vectors = (l.width + SV_LANES - 1) / SV_LANES;
    const uint pitch = padded_width_of(&l) / SV_LANES;
    const bool padded = padding <= 255;
    __global ushort16 *first = (__global ushort16 *)ray_row(rays, &l, RAY_FIRST, y);
    __global ushort16 *end = (__global ushort16 *)ray_row(rays, &l, RAY_END, y);
    __global const ushort16 *from = (__global const ushort16 *)(scanned + (size_t)y * scanned_width);
    __global const ushort16 *to = from + (size_t)l.height * scanned_width / SV_LANES;
    const uchar16 inside = pixels_of((vectors - 1) * SV_LANES, l.width);
    if (first_slice == 0) begin_ranges(&l, padded, ranged != 0, scanned_width, scanned, rays, y);
    slab += slab_offset + (size_t)y * row_pitch;
    for (uint i = 0; i < slice_count; i++) {
        const ushort z = (ushort)(first_slice + i);
        __global const uchar *row = slab + (size_t)(i / tiles_x) * tile_h * row_pitch + i % tiles_x * tile_w;
        __global uchar16 *kept = voxels + ((size_t)z * l.height + y) * pitch;
        for (uint x = 0; x < vectors; x++) {
            uchar16 v = load_voxels(row, x * SV_LANES, l.width);
            if (x + 1 == vectors) v &= inside;
            if (ranged) v &= bytes16_of((from[x] <= z) & (to[x] > z));
            if (padded) {
                short16 seen = words16_of(as_uchar16(v != (uchar16)((uchar)padding)));
                if (x + 1 == vectors) seen &= words16_of(inside);
                if (ranged) seen &= (from[x] <= z) & (to[x] > z);
                v &= bytes16_of(seen);
                first[x] = min(first[x], select((ushort16)(NEVER), (ushort16)(z), as_ushort16(seen)));
                end[x] = max(end[x], (ushort16)((ushort)(z + 1)) & as_ushort16(seen));
            }
            kept[x] = v;
        }
        for (uint x = vectors; x < pitch; x++) kept[x] = (uchar16)(0);
    }
}
