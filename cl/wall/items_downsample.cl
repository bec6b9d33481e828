/* SPDX-License-Identifier: MIT */
/* By work items, while the slabs come: the scanned range of a pixel, and the mean of a block. */
#ifndef SV_WALL_SLICES_CLH
#include "wall/wall_slices.clh"
#endif

/* Sets a pixel's range as far as it is known without the voxels. */
static void begin_range(const sv_wall_layout *l, uint padding, bool ranged, uint from, uint to, uint *first,
                        uint *end) {
    *first = NEVER;
    *end = 0;
    if (padding <= 255 || (ranged && from >= to)) return;
    *first = ranged ? from : 0;
    *end = ranged ? to : l->slices;
}

/* One work item per pixel, with the arguments of wall_downsample but for its blocks. It is launched for
 * every slab if there is a padding value, else for the first one only. */
__kernel void wall_items_range(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch,
                               uint tiles_x, uint tile_w, uint tile_h, uint first_slice, uint slice_count,
                               uint padding, uint ranged, uint range_pitch,
                               __global const ushort *restrict scanned, sv_wall_layout l,
                               __global ushort *restrict ranges) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.width) return;
    const texture_t t = {slab + slab_offset, row_pitch, tiles_x, tile_w, tile_h};
    const size_t at = (size_t)y * range_pitch + x, plane = (size_t)l.height * range_pitch;
    const uint from = ranged ? scanned[at] : 0, to = ranged ? scanned[plane + at] : l.slices;
    uint first = ranges[at], end = ranges[plane + at];
    if (first_slice == 0) begin_range(&l, padding, ranged != 0, from, to, &first, &end);
    for (uint i = 0; padding <= 255 && i < slice_count; i++) {
        const uint z = first_slice + i;
        const bool seen = slice_of(&t, i)[(size_t)y * row_pitch + x] != padding && z >= from && z < to;
        first = seen ? min(first, z) : first;
        end = seen ? z + 1 : end;
    }
    ranges[at] = (ushort)first;
    ranges[plane + at] = (ushort)end;
}

/* Sums up a block over one slice, weighted; padding counts as 0. */
static uint sum_slice(__global const uchar *at, uint row_pitch, __global const sv_wall_span *across,
                      __global const sv_wall_span *along, uint padding) {
    uint sum = 0;
    for (uint j = 0; j < along->count; j++, at += row_pitch) {
        uint of_row = 0;
        for (uint i = 0; i < across->count; i++)
            of_row += at[i] == padding ? 0u : (uint)across->weight[i] * at[i];
        sum += along->weight[j] * of_row;
    }
    return sum;
}

/*
 * One work item per block of the layers that the slab reaches: column by row + rows * layer. `sums` carries a
 * layer that ends in a later slab, one number a ray. If the slab begins within a layer and ends within
 * another, the same work item takes both, so it reads its sum before it is overwritten, and one layer less is
 * launched.
 */
__kernel void wall_items_downsample(__global const uchar *restrict slab, ulong slab_offset, uint row_pitch,
                                    uint tiles_x, uint tile_w, uint tile_h, uint first_slice,
                                    uint slice_count, uint padding, uint ranged, uint range_pitch,
                                    __global const ushort *restrict scanned, sv_wall_layout l,
                                    __global const sv_wall_span *restrict spans, __global uint *restrict sums,
                                    __global uchar *restrict levels) {
    const uint x = (uint)get_global_id(0), row = (uint)get_global_id(1) % l.rows;
    if (x >= l.columns) return;
    const uint launched = (uint)get_global_size(1) / l.rows, slab_end = first_slice + slice_count;
    __global const sv_wall_span *across = spans + x, *along = spans + l.columns + row;
    const texture_t t = {slab + slab_offset, row_pitch, tiles_x, tile_w, tile_h};
    const size_t corner = (size_t)along->first * row_pitch + across->first;
    __global uint *carried = sums + block_row(&l, 0, row) + x;
    for (uint layer = first_slice / l.depth + (uint)get_global_id(1) / l.rows; layer * l.depth < slab_end;
         layer += launched) {
        const uint begin = layer * l.depth, end = min(begin + l.depth, l.slices);
        uint sum = begin < first_slice ? *carried : 0;
        for (uint z = max(begin, first_slice); z < min(end, slab_end); z++)
            sum += sum_slice(slice_of(&t, z - first_slice) + corner, row_pitch, across, along, padding);
        const uint weight = SV_WALL_SPAN_ONE * SV_WALL_SPAN_ONE * (end - begin);
        if (end <= slab_end)
            levels[level_row(&l, layer, row) + x] = (uchar)((sum + weight / 2) / weight);
        else
            *carried = sum;
    }
}
