/* SPDX-License-Identifier: MIT */
/*
 * The surface has no pits that are narrower than opening_of(..) to either side (docs/surface.md, step 10):
 * its grey opening, a minimum over rectangles of rays and then a maximum. Beyond the border there is nothing.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif

/* Takes the least or the largest of 16 values each. */
static float16 extreme(float16 a, float16 b, bool least) {
    return least ? fmin(a, b) : fmax(a, b);
}

/* Loads 16 places of row `y`, and `beyond` where a ray was not scanned. Without `rays` all count. */
static float16 scanned_places(const sv_wall_layout *l, __global const ushort *rays,
                              __global const float *plane, uint y, uint x, float beyond) {
    const float16 planes = *(__global const float16 *)(plane + plane_row(l, 0, y) + x);
    if (!rays) return planes;
    const ushort16 first = *(__global const ushort16 *)(rays + block_row(l, RAY_FIRST, y) + x);
    const ushort16 end = *(__global const ushort16 *)(rays + block_row(l, RAY_END, y) + x);
    return select((float16)(beyond), planes, convert_int16(as_short16(first < end)));
}

/* Finds the extremes of a plane down the rows near `row`, for every column. The line goes on with `beyond` to
 * either side. */
static void extremes_down(const sv_wall_layout *l, uint2 reach, __global const ushort *rays,
                          __global const float *plane, uint row, bool least, __global float *line) {
    const uint from = row - min(row, reach.y), to = min(row + reach.y, l->rows - 1);
    const float beyond = least ? (float)l->layers : 0.0f;
    for (uint x = 0; x < l->columns; x += SV_LANES) {
        float16 found = (float16)(beyond);
        for (uint y = from; y <= to; y++)
            found = extreme(found, scanned_places(l, rays, plane, y, x, beyond), least);
        *(__global float16 *)(line + x) = found;
    }
    for (uint k = 1; k <= reach.x; k++) line[-(int)k] = beyond;
    for (uint x = l->columns; x < padded_columns_of(l) + reach.x; x++) line[x] = beyond;
}

/* Finds the extremes of 16 values of a line and of those near them. */
static float16 extremes_across(uint2 reach, __global const float *line, bool least) {
    float16 found = *(__global const float16 *)line;
    for (int k = 1; k <= (int)reach.x; k++)
        found = extreme(found, extreme(vload16(0, line - k), vload16(0, line + k), least), least);
    return found;
}

static __global float *line_of_row(__global uint *scratch, uint row, uint scratch_words) {
    return (__global float *)(scratch + (size_t)row * scratch_words) + MARGIN;
}

/* One work item per row of rays: the minima of the three planes of medians. `scratch`: scratch_words words of
 * 32 bits for each row. */
__kernel void wall_erode(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                         __global const ushort *restrict rays, __global uint *restrict scratch,
                         __global float *restrict planes) {
    const uint row = (uint)get_global_id(0);
    __global float *line = line_of_row(scratch, row, scratch_words);
    const uint2 reach = opening_of(&l, info);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint i = 0; i < PLANE_MEDIANS; i++) {
        __global float *eroded = planes + plane_row(&l, eroded_plane(i), row);
        extremes_down(&l, reach, rays, planes + plane_row(&l, PLANE_MEDIAN + i, 0), row, true, line);
        for (uint x = 0; x < l.columns; x += SV_LANES)
            *(__global float16 *)(eroded + x) = extremes_across(reach, line + x, true);
    }
}

/* One work item per row of rays, after wall_erode: the maxima of these minima, if they are less than the
 * medians. */
__kernel void wall_open(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                        __global uint *restrict scratch, __global float *restrict planes) {
    const uint row = (uint)get_global_id(0);
    __global float *line = line_of_row(scratch, row, scratch_words);
    const uint2 reach = opening_of(&l, info);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint i = 0; i < PLANE_MEDIANS; i++) {
        __global float *place = planes + plane_row(&l, PLANE_MEDIAN + i, row);
        extremes_down(&l, reach, NULL, planes + plane_row(&l, eroded_plane(i), 0), row, false, line);
        for (uint x = 0; x < l.columns; x += SV_LANES)
            *(__global float16 *)(place + x) =
                fmin(*(__global const float16 *)(place + x), extremes_across(reach, line + x, false));
    }
}
