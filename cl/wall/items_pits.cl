/* SPDX-License-Identifier: MIT */
/* By work items: the surface has no narrow pits. wall_pits.cl says how. */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif

/* The rays of the rectangle around a ray: columns and rows from .. to. */
typedef struct {
    uint left, right, top, bottom;
} rectangle_t;

static rectangle_t rectangle_around(const sv_wall_layout *l, uint2 reach, uint x, uint y) {
    return (rectangle_t){x - min(x, reach.x), min(x + reach.x, l->columns - 1), y - min(y, reach.y),
                         min(y + reach.y, l->rows - 1)};
}

/* One work item per ray: the minima of the three planes of medians. */
__kernel void wall_items_erode(sv_wall_layout l, __global const uint *restrict info,
                               __global const ushort *restrict rays, __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const rectangle_t r = rectangle_around(&l, opening_of(&l, info), x, y);
    for (uint plane = 0; plane < PLANE_MEDIANS; plane++) {
        float least = (float)l.layers;
        for (uint v = r.top; v <= r.bottom; v++)
            for (uint u = r.left; u <= r.right; u++) {
                const bool scanned =
                    rays[block_row(&l, RAY_FIRST, v) + u] < rays[block_row(&l, RAY_END, v) + u];
                if (scanned) least = fmin(least, planes[plane_row(&l, PLANE_MEDIAN + plane, v) + u]);
            }
        planes[plane_row(&l, eroded_plane(plane), y) + x] = least;
    }
}

/* One work item per ray, after wall_items_erode: the maxima of these minima, if they are less than the
 * medians. */
__kernel void wall_items_open(sv_wall_layout l, __global const uint *restrict info,
                              __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const rectangle_t r = rectangle_around(&l, opening_of(&l, info), x, y);
    for (uint plane = 0; plane < PLANE_MEDIANS; plane++) {
        float largest = 0.0f;
        for (uint v = r.top; v <= r.bottom; v++)
            for (uint u = r.left; u <= r.right; u++)
                largest = fmax(largest, planes[plane_row(&l, eroded_plane(plane), v) + u]);
        __global float *place = planes + plane_row(&l, PLANE_MEDIAN + plane, y) + x;
        *place = fmin(*place, largest);
    }
}
