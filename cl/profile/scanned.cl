/* SPDX-License-Identifier: MIT */
/*
 * Scanned ranges (spec 2; sv_frame.scanned): from the host's pairs, row by row without a gap, to two planes
 * of padded rows, SV_SCANNED_FIRST and SV_SCANNED_END, so that neighbouring rays are neighbouring lanes.
 *
 *     pairs:   f e f e f e ...        plane of first:  f f f ... 0 0      (padding: nothing is scanned)
 *                                     plane of end:    e e e ... 0 0
 */
#ifndef SV_SHARED_H
#include "common/sv_shared.h"
#endif

/* One work item per row. An end beyond the volume is cut off. */
__kernel void scanned_planes(__global const ushort *restrict pairs, ulong offset, uint width,
                             uint padded_width, uint height, uint slices, __global ushort *restrict scanned) {
    const uint y = (uint)get_global_id(0);
    __global const ushort *from = pairs + offset + (size_t)y * width * 2;
    __global ushort *first = scanned + (size_t)y * padded_width;
    __global ushort *end = first + (size_t)SV_SCANNED_END * padded_width * height;
    for (uint x = 0; x < width; x++) {
        first[x] = from[2 * x];
        end[x] = min(from[2 * x + 1], (ushort)slices);
    }
    for (uint x = width; x < padded_width; x++) first[x] = end[x] = 0;
}
