/* SPDX-License-Identifier: MIT */
/*
 * By work items, from the layers of rays to the surface: the median, the confidence, and the interpolation to
 * pixels. Beyond the border the ray at the border counts. Every float32 is computed in the order of
 * wall_surface.cl.
 */
#ifndef SV_WALL_ITEMS_CLH
#include "wall/items.clh"
#endif
#ifndef SV_WALL_MEDIAN_CLH
#include "wall/wall_median.clh"
#endif
#ifndef SV_WALL_PIXELS_CLH
#include "wall/wall_pixels.clh"
#endif
#ifndef SV_WALL_RIM_CLH
#include "wall/wall_rim.clh"
#endif

/* Loads a ray and its eight neighbours. */
static void neighbours(const sv_wall_layout *l, __global const float *plane, uint x, uint y, float *out) {
    const int dx = (int)l->median_step[0], dy = (int)l->median_step[1];
    for (int v = -1; v <= 1; v++)
        for (int u = -1; u <= 1; u++)
            *out++ = plane[plane_row(l, 0, clamped(y, v * dy, l->rows)) + clamped(x, u * dx, l->columns)];
}

static float median_at(const sv_wall_layout *l, __global const float *planes, uint plane, uint x, uint y) {
    float near[9];
    neighbours(l, planes + plane_row(l, plane, 0), x, y, near);
    return l->median ? median(near) : near[4];
}

/* One work item per ray: the medians of the layers and of the ends around them. The planes it writes are none
 * of those it reads. */
__kernel void wall_items_median(sv_wall_layout l, __global const uint *restrict info,
                                __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    planes[plane_row(&l, PLANE_MEDIAN, y) + x] = median_at(&l, planes, PLANE_LAYER, x, y);
    planes[plane_row(&l, PLANE_MEDIAN_NEAR, y) + x] = median_at(&l, planes, PLANE_NEAR, x, y);
    planes[plane_row(&l, PLANE_MEDIAN_FAR, y) + x] = median_at(&l, planes, PLANE_FAR, x, y);
}

/* Adds the blocks of a ray that are as dark as `fluid` to `gaps`: all of them, and those in the fluid of
 * layer `at`, if tissue lies on both of its sides; a thin dim front of it does not count. */
static void add_gaps(const sv_wall_layout *l, __global const uchar *levels, __global const uchar *relative,
                     uint first, uint end, uint fluid, uint at, __local uint *gaps) {
    const size_t pitch = level_pitch_of(l);
    uint all = 0, in_gaps = 0, in_fluid = 0, open = 0;
    uint holds = 0, behind_tissue = 0;
    for (uint z = first; z < end; z++) {
        const uint dark = levels[z * pitch] <= fluid, related = relative[z * pitch];
        const uint tissue = related > SV_WALL_TISSUE;
        all += dark;
        in_gaps += (holds & tissue & behind_tissue) * in_fluid;
        open += (1 - tissue) & (uint)(z == first);
        in_fluid = (1 - tissue) * (in_fluid + dark);
        holds = (1 - tissue) & (holds | (uint)(z == at));
        behind_tissue |= tissue & ((uint)(related > SV_WALL_DIM_TISSUE) | (uint)(z - first >= l->dim_front));
    }
    atomic_add(gaps, all);
    atomic_add(gaps + 1, in_gaps);
    atomic_add(gaps + 2, open);
}

/* One work group per row of cells: counts the darkest blocks of its rays, those of them in gaps, and the
 * rays that begin in the fluid. */
__kernel void wall_items_gaps(sv_wall_layout l, __global const uint *restrict info,
                              __global const uchar *restrict levels, __global const uchar *restrict relative,
                              __global const ushort *restrict rays, __global const float *restrict planes,
                              __global ulong *restrict gaps) {
    __local uint sums[3];
    const uint item = (uint)get_local_id(0), row = (uint)get_group_id(0);
    const uint count = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE ? 2 * l.columns : 0;
    if (item < 3) sums[item] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < count; i += (uint)get_local_size(0)) {
        const ray_place_t at = ray_of_group(&l, i);
        const size_t from = level_row(&l, 0, at.row) + at.x;
        const uint first = rays[block_row(&l, RAY_FIRST, at.row) + at.x];
        const uint end = rays[block_row(&l, RAY_END, at.row) + at.x];
        const float place = planes[plane_row(&l, PLANE_MEDIAN, at.row) + at.x];
        add_gaps(&l, levels + from, relative + from, first, end, info[SV_WALL_INFO_FLUID],
                 gap_layer(&l, relative + from, first, place), sums);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item < 3) gaps[3 * row + item] = sums[item];
}

/* True if two blocks near a surface in layer `at` are dark. `levels`: relative ones, of the ray's first
 * layer on. */
static bool is_near_fluid(const sv_wall_layout *l, __global const uchar *levels, uint first, uint end,
                          uint at) {
    const size_t pitch = level_pitch_of(l);
    uint dark = 0;
    for (uint z = max(first, at - min(at, l->full_distance)); z < min(end, at + l->full_distance + 1); z++)
        dark += levels[z * pitch] <= l->dim;
    return dark >= SV_WALL_OWN_FLUID;
}

/* One work item per ray: the confidence, and whether the ray has fluid of its own. */
__kernel void wall_items_confidence(sv_wall_layout l, __global const uint *restrict info,
                                    __global const uchar *restrict levels, __global ushort *restrict rays,
                                    __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const uint at = (uint)planes[plane_row(&l, PLANE_MEDIAN, y) + x];
    const float level = (float)levels[level_row(&l, at, y) + x] / SV_WALL_TISSUE;
    planes[plane_row(&l, PLANE_LAYER, y) + x] =
        confidence_of(&l, planes[plane_row(&l, PLANE_COST, y) + x], level);
    const size_t plane = block_row(&l, 1, 0);
    rays += block_row(&l, 0, y) + x;
    const bool own = rays[RAY_FRONT * plane] != l.layers ||
                     rays[RAY_RUN * plane] == rays[RAY_RUN_END * plane] ||
                     is_near_fluid(&l, levels + level_row(&l, 0, y) + x, rays[0], rays[RAY_END * plane], at);
    if (!own) rays[RAY_FRONT * plane] = SV_WALL_NO_OWN_FLUID;
}

/* One work group per row of cells: what its rays know of the surface. */
__kernel void wall_items_known(sv_wall_layout l, __global const uint *restrict info,
                               __global const ushort *restrict rays, __global const float *restrict planes,
                               __global uint4 *restrict rim) {
    const uint row = (uint)get_group_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint x = (uint)get_local_id(0); x < l.cells[0]; x += (uint)get_local_size(0))
        rim[(size_t)row * l.cells[0] + x] = mean_of_rays(&l, rays, planes, x, row);
}

/* One work item per ray: moves the surface in its range, to the far end at q = 0, to the near end at q = 1,
 * linear to either side of 0.5. From there it may go back. */
__kernel void wall_items_knob(sv_wall_layout l, __global const uint *restrict info,
                              __global const uchar *restrict levels, __global const ushort *restrict rays,
                              __global const ushort *restrict fine, __global const uint4 *restrict rim,
                              __global float *restrict planes) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.columns || info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const float part = fabs(2.0f * l.q - 1.0f), place = planes[plane_row(&l, PLANE_MEDIAN, y) + x];
    const float end = planes[plane_row(&l, l.q < 0.5f ? PLANE_MEDIAN_FAR : PLANE_MEDIAN_NEAR, y) + x];
    float at = fmax(place + part * (end - place), 0.0f);
    if (rays[block_row(&l, RAY_FRONT, y) + x] == SV_WALL_NO_OWN_FLUID)
        at = go_on(&l, levels, rays, fine, rim, planes, x, y, part);
    planes[plane_row(&l, PLANE_SURFACE, y) + x] = move_back(&l, levels, rays, x, y, at);
}

/* One work item per pixel. The depthmap at q, from value `first` on; zeros if there is no surface. */
__kernel void wall_items_upsample(sv_wall_layout l, __global const uint *restrict info,
                                  __global const float *restrict planes, __global float *restrict confidence,
                                  ulong first, __global float *restrict depths) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= l.width) return;
    const bool wanted = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    const float most = most_confidence(&l, info);
    const pair_t u = pair_of(between(x, l.width, l.columns), l.width, l.columns);
    const pair_t v = pair_of(between(y, l.height, l.rows), l.height, l.rows);
    const float depth = (float)l.depth * interpolate(&l, planes + plane_row(&l, PLANE_SURFACE, 0), u, v);
    const float certainty = most * fmin(interpolate(&l, planes, u, v), 1.0f); /* weights are rounded */
    depths[first + (size_t)y * l.width + x] = wanted ? depth : 0.0f;
    confidence[(size_t)y * l.width + x] = wanted ? certainty : 0.0f;
}
