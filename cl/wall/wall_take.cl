/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, while the slabs come: every voxel is read once and kept, 0 where it was not scanned;
 * and the scanned range of every ray.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

#define NEVER 32767 /* first slice of a ray that was not scanned */

/* Row y of ray ranges before the first slab: all that can be said without the voxels. */
static void begin_ranges(const sv_wall_layout *l, bool padded, bool ranged, __global const ushort16 *scanned,
                         __global ushort16 *rays, uint y) {
    __global ushort16 *first = ray_row(rays, l, RAY_FIRST, y), *end = ray_row(rays, l, RAY_END, y);
    const uint vectors = padded_width_of(l) / SV_LANES;
    __global const ushort16 *from = scanned + (size_t)y * vectors, *to = from + (size_t)l->height * vectors;
    for (uint x = 0; x < vectors; x++) {
        first[x] = (ushort16)((ushort)(padded ? NEVER : 0));
        end[x] = (ushort16)((ushort)(padded ? 0 : l->slices));
        if (ranged && !padded) {
            const ushort16 some = as_ushort16(from[x] < to[x]);
            first[x] = select((ushort16)(NEVER), from[x], some);
            end[x] = to[x] & some;
        }
    }
    /* Behind the last ray: never. */
    if (l->width % SV_LANES)
        end[vectors - 1] &= as_ushort16(convert_short16(LANE_NUMBERS) < (short)(l->width % SV_LANES));
}

/* One work item per row of rays. `ranged`: `scanned` has planes of the rays' ranges. With a padding value the
 * range of a ray goes from its first voxel of another value to its last. */
__kernel void wall_take(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch, uint tiles_x,
                        uint tile_w, uint tile_h, uint first_slice, uint slice_count, uint padding,
                        uint ranged, __global const ushort16 *restrict scanned, sv_wall_layout l,
                        __global uchar16 *restrict voxels, __global ushort16 *restrict rays) {
    const uint y = (uint)get_global_id(0), vectors = padded_width_of(&l) / SV_LANES;
    const bool padded = padding <= 255;
    __global ushort16 *first = ray_row(rays, &l, RAY_FIRST, y), *end = ray_row(rays, &l, RAY_END, y);
    __global const ushort16 *from = scanned + (size_t)y * vectors, *to = from + (size_t)l.height * vectors;
    const uchar16 inside = pixels_of((vectors - 1) * SV_LANES, l.width);
    if (first_slice == 0) begin_ranges(&l, padded, ranged != 0, scanned, rays, y);
    slab += slab_offset + (size_t)y * row_pitch;
    for (uint i = 0; i < slice_count; i++) {
        const ushort z = (ushort)(first_slice + i);
        __global const uchar *row = slab + (size_t)(i / tiles_x) * tile_h * row_pitch + i % tiles_x * tile_w;
        __global uchar16 *kept = voxels + ((size_t)z * l.height + y) * vectors;
        for (uint x = 0; x < vectors; x++) {
            uchar16 v = load_voxels(row, x * SV_LANES, l.width);
            if (x + 1 == vectors) v &= inside;
            if (ranged) v &= bytes_of((from[x] <= z) & (to[x] > z));
            if (padded) {
                short16 seen = words_of(as_uchar16(v != (uchar16)((uchar)padding)));
                if (x + 1 == vectors) seen &= words_of(inside);
                if (ranged) seen &= (from[x] <= z) & (to[x] > z);
                v &= bytes_of(seen);
                first[x] = min(first[x], select((ushort16)(NEVER), (ushort16)(z), as_ushort16(seen)));
                end[x] = max(end[x], (ushort16)((ushort)(z + 1)) & as_ushort16(seen));
            }
            kept[x] = v;
        }
    }
}
