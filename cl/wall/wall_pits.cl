/* SPDX-License-Identifier: MIT */
/*
 * A doubtful surface has no pits that are narrower than l.opening to either side (docs/surface.md, step 10):
 * its grey opening, a minimum over rectangles of rays and then a maximum. Beyond the border there is nothing.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif

static bool fills_pits(__global const uint *info) {
    return info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE && info[SV_WALL_INFO_DOUBTFUL];
}

/* Loads 16 places of a plane; where a ray was not scanned, `otherwise`. */
static float16 scanned_places(const sv_wall_layout *l, __global const ushort *rays,
                              __global const float *places, uint plane, uint y, uint x, float otherwise) {
    const ushort16 first = *(__global const ushort16 *)(rays + block_row(l, RAY_FIRST, y) + x);
    const ushort16 end = *(__global const ushort16 *)(rays + block_row(l, RAY_END, y) + x);
    const int16 scanned = convert_int16(as_short16(first < end));
    return select((float16)(otherwise), *(__global const float16 *)(places + place_row(l, plane, y) + x),
                  scanned);
}

/* Sets what lies beyond the ends of a line of rays. */
static void close_line(const sv_wall_layout *l, __global float *line, float value) {
    for (uint k = 1; k <= l->opening[0]; k++) line[-(int)k] = value;
    for (uint x = l->columns; x < padded_columns_of(l) + l->opening[0]; x++) line[x] = value;
}

/* Finds the least or the largest of 16 values of a line and of those near them. */
static float16 extreme_near(const sv_wall_layout *l, __global const float *line, bool least) {
    float16 extreme = *(__global const float16 *)line;
    for (int k = 1; k <= (int)l->opening[0]; k++) {
        const float16 left = vload16(0, line - k), right = vload16(0, line + k);
        extreme = least ? fmin(extreme, fmin(left, right)) : fmax(extreme, fmax(left, right));
    }
    return extreme;
}

/* One work item per row of rays: the minima of the three planes of medians. `scratch`: scratch_words words of
 * 32 bits for each row. */
__kernel void wall_erode(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                         __global const ushort *restrict rays, __global uint *restrict scratch,
                         __global float *restrict places) {
    const uint row = (uint)get_global_id(0);
    const uint from = row - min(row, l.opening[1]), to = min(row + l.opening[1], l.rows - 1);
    __global float *line = (__global float *)(scratch + (size_t)row * scratch_words) + MARGIN;
    if (!fills_pits(info)) return;
    for (uint plane = 0; plane < PLACE_MEDIANS; plane++) {
        for (uint x = 0; x < l.columns; x += SV_LANES) {
            float16 least = (float16)((float)l.layers);
            for (uint y = from; y <= to; y++)
                least = fmin(least,
                             scanned_places(&l, rays, places, PLACE_MEDIAN + plane, y, x, (float)l.layers));
            *(__global float16 *)(line + x) = least;
        }
        close_line(&l, line, (float)l.layers);
        for (uint x = 0; x < l.columns; x += SV_LANES)
            *(__global float16 *)(places + place_row(&l, eroded_plane(plane), row) + x) =
                extreme_near(&l, line + x, true);
    }
}

/* One work item per row of rays, after wall_erode: the maxima of these minima, if they are less than the
 * medians. */
__kernel void wall_open(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                        __global uint *restrict scratch, __global float *restrict places) {
    const uint row = (uint)get_global_id(0);
    const uint from = row - min(row, l.opening[1]), to = min(row + l.opening[1], l.rows - 1);
    __global float *line = (__global float *)(scratch + (size_t)row * scratch_words) + MARGIN;
    if (!fills_pits(info)) return;
    for (uint plane = 0; plane < PLACE_MEDIANS; plane++) {
        for (uint x = 0; x < l.columns; x += SV_LANES) {
            float16 largest = (float16)(0.0f);
            for (uint y = from; y <= to; y++)
                largest = fmax(
                    largest, *(__global const float16 *)(places + place_row(&l, eroded_plane(plane), y) + x));
            *(__global float16 *)(line + x) = largest;
        }
        close_line(&l, line, 0.0f);
        for (uint x = 0; x < l.columns; x += SV_LANES) {
            __global float16 *place =
                (__global float16 *)(places + place_row(&l, PLACE_MEDIAN + plane, row) + x);
            *place = fmin(*place, extreme_near(&l, line + x, false));
        }
    }
}
