/* SPDX-License-Identifier: MIT */
/*
 * From the layers of rays to the surface: the median, the confidence, and the interpolation to pixels. Beyond
 * the border the ray at the border counts.
 */
#ifndef SV_WALL_SCANNED_CLH
#include "wall/wall_scanned.clh"
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

/* Loads 16 rays of a row from x + step on. */
static float16 load_places(__global const float *row, uint x, int step, uint columns) {
    const int from = (int)x + step;
    float lanes[SV_LANES];
    if (from >= 0 && from + SV_LANES <= (int)columns) return vload16(0, row + from);
    TABLE_LOADS
    for (uint i = 0; i < SV_LANES; i++) lanes[i] = row[clamped(x + i, step, columns)];
    return *(const float16 *)lanes;
}

/* Loads 16 rays and their eight neighbours. */
static void neighbours(const sv_wall_layout *l, __global const float *plane, uint x, uint y, float16 *out) {
    const int dx = (int)l->median_step[0], dy = (int)l->median_step[1];
    for (int v = -1; v <= 1; v++) {
        __global const float *row = plane + plane_row(l, 0, clamped(y, v * dy, l->rows));
        for (int u = -1; u <= 1; u++) *out++ = load_places(row, x, u * dx, l->columns);
    }
}

/* Returns the medians of 16 rays of a plane. */
static float16 median_at(const sv_wall_layout *l, __global const float *planes, uint plane, uint x, uint y) {
    float16 near[9];
    neighbours(l, planes + plane_row(l, plane, 0), x, y, near);
    return l->median ? median(near) : near[4];
}

/* One work item per row of rays: the medians of the layers and of the ends around them. */
__kernel void wall_median(sv_wall_layout l, __global const uint *restrict info,
                          __global float *restrict planes) {
    const uint y = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    __global float *filtered = planes + plane_row(&l, PLANE_MEDIAN, y);
    __global float *near = planes + plane_row(&l, PLANE_MEDIAN_NEAR, y);
    __global float *far = planes + plane_row(&l, PLANE_MEDIAN_FAR, y);
    for (uint x = 0; x < l.columns; x += SV_LANES) {
        *(__global float16 *)(filtered + x) = median_at(&l, planes, PLANE_LAYER, x, y);
        *(__global float16 *)(near + x) = median_at(&l, planes, PLANE_NEAR, x, y);
        *(__global float16 *)(far + x) = median_at(&l, planes, PLANE_FAR, x, y);
    }
}

/* Adds the blocks of LANES rays that are as dark as `fluid` to `gaps`: all of them, and those in the gap of
 * their ray. That is the fluid of layer `at`, if tissue lies on both of its sides; a thin dim front of it
 * does not count. `in`: the layers in which any of them was scanned. */
static void add_gaps(const sv_wall_layout *l, __global const uchar *levels, __global const uchar *relative,
                     i16l first, i16l end, extent_t in, uint fluid, i16l at, ulong gaps[3]) {
    const u8l fluid_level = (u8l)((uchar)fluid);
    const size_t pitch = level_pitch_of(l);
    u16l all = (u16l)(0), in_gaps = all, in_fluid = all, open = all;
    i16l holds = (i16l)(0), behind_tissue = holds;
    for (uint z = in.from; z < in.to; z++) {
        const u8l level = ((__global const u8l_unaligned *)(levels + z * pitch))->v;
        const u8l related = ((__global const u8l_unaligned *)(relative + z * pitch))->v;
        const i16l here = (i16l)((short)z), scanned = (first <= here) & (end > here);
        const i16l tissue = words_of(tissue_of(related)) & scanned;
        const i16l more_than_dim = words_of(AS_U8(related > (u8l)((uchar)SV_WALL_DIM_TISSUE))) & scanned;
        const u16l dark = AS_U16(words_of(AS_U8(level <= fluid_level)) & scanned) & (u16l)(1);
        all += dark;
        in_gaps += in_fluid & AS_U16(holds & tissue & behind_tissue);
        open += AS_U16((first == here) & scanned & ~tissue) & (u16l)(1);
        in_fluid = (in_fluid + dark) & AS_U16(~tissue);
        holds = (holds | ((at == here) & scanned)) & ~tissue;
        behind_tissue |= more_than_dim | (tissue & (here - first >= (i16l)((short)l->dim_front)));
    }
    const ushort *counts[3] = {(const ushort *)&all, (const ushort *)&in_gaps, (const ushort *)&open};
    for (uint k = 0; k < 3; k++)
        for (uint i = 0; i < LANES; i++) gaps[k] += counts[k][i];
}

/* One work item per row of cells: counts the darkest blocks of its rays, those of them in gaps, and the
 * rays that begin in the fluid. */
__kernel void wall_gaps(sv_wall_layout l, __global const uint *restrict info,
                        __global const uchar *restrict levels, __global const uchar *restrict relative,
                        __global ushort *restrict rays, __global const float *restrict planes,
                        __global ulong *restrict gaps) {
    const uint row = (uint)get_global_id(0);
    ulong sums[3] = {0, 0, 0};
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint y = 2 * row; y < 2 * row + 2; y++)
        for (uint x = 0; x < l.columns; x += LANES) {
            __global const uchar *from = relative + level_row(&l, 0, y) + x;
            const i16l first = AS_I16(ray_row(rays, &l, RAY_FIRST, y)[x / LANES]);
            const i16l end = AS_I16(ray_row(rays, &l, RAY_END, y)[x / LANES]);
            i16l at = (i16l)(0), is_ray = (i16l)(0); /* behind the last column nothing is defined */
            ROLLED_LOADS
            for (uint i = 0; i < min((uint)LANES, l.columns - x); i++) {
                ((short *)&is_ray)[i] = -1;
                ((short *)&at)[i] = (short)gap_layer(&l, from + i, rays[block_row(&l, RAY_FIRST, y) + x + i],
                                                     planes[plane_row(&l, PLANE_MEDIAN, y) + x + i]);
            }
            add_gaps(&l, levels + level_row(&l, 0, y) + x, from, first, end & is_ray,
                     extent_of_vector(&l, rays, row, x / LANES), info[SV_WALL_INFO_FLUID], at, sums);
        }
    for (uint k = 0; k < 3; k++) gaps[3 * row + k] = sums[k];
}

/* Where two blocks near the surfaces of LANES rays, in layers `at`, are dark. */
static i16l are_near_fluid(const sv_wall_layout *l, __global const uchar *levels, i16l first, i16l end,
                           i16l at) {
    const u8l dim = (u8l)((uchar)l->dim);
    const i16l reach = (i16l)((short)l->full_distance);
    const size_t pitch = level_pitch_of(l);
    const short *lanes = (const short *)&at;
    short from = lanes[0], to = lanes[0];
    for (uint i = 1; i < LANES; i++) {
        from = min(from, lanes[i]);
        to = max(to, lanes[i]);
    }
    i16l dark = (i16l)(0); /* counted downwards: a mask is -1 */
    for (uint z = (uint)from - min((uint)from, l->full_distance);
         z < min((uint)to + l->full_distance + 1, l->layers); z++) {
        const i16l here = (i16l)((short)z);
        const i16l near = (first <= here) & (end > here) & (here - at <= reach) & (at - here <= reach);
        dark += words_of(AS_U8(((__global const u8l_unaligned *)(levels + z * pitch))->v <= dim)) & near;
    }
    return dark <= (i16l)((short)-SV_WALL_OWN_FLUID);
}

/* Stores which of LANES rays have no fluid of their own. `levels`: relative ones, of the rays' first layer
 * on. `places`: of their surfaces, `count` of them. */
static void find_own_fluid(const sv_wall_layout *l, __global const uchar *levels, __global ushort *rays,
                           __global const float *places, uint x, uint y, uint count) {
    __global u16l *front = ray_row(rays, l, RAY_FRONT, y) + x;
    const i16l first = AS_I16(ray_row(rays, l, RAY_FIRST, y)[x]);
    const i16l end = AS_I16(ray_row(rays, l, RAY_END, y)[x]);
    const i16l tissue = AS_I16(ray_row(rays, l, RAY_RUN, y)[x] != ray_row(rays, l, RAY_RUN_END, y)[x]);
    i16l at = (i16l)((short)places[0]); /* behind the last column nothing is defined */
    ROLLED_LOADS
    for (uint i = 1; i < count; i++) ((short *)&at)[i] = (short)places[i];
    const i16l none =
        tissue & AS_I16(*front == (u16l)((ushort)l->layers)) & ~are_near_fluid(l, levels, first, end, at);
    *front |= AS_U16(none); /* SV_WALL_NO_OWN_FLUID */
}

/* One work item per row of rays: the confidence, and whether the rays have fluid of their own. */
__kernel void wall_confidence(sv_wall_layout l, __global const uint *restrict info,
                              __global const uchar *restrict levels, __global ushort *restrict rays,
                              __global float *restrict planes) {
    const uint y = (uint)get_global_id(0);
    const size_t pitch = level_pitch_of(&l);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    __global const float *filtered = planes + plane_row(&l, PLANE_MEDIAN, y);
    __global const float *costs = planes + plane_row(&l, PLANE_COST, y);
    __global float *confidence = planes + plane_row(&l, PLANE_LAYER, y);
    levels += level_row(&l, 0, y);
    ROLLED_LOADS
    for (uint x = 0; x < l.columns; x++)
        confidence[x] = (float)levels[(uint)filtered[x] * pitch + x] / SV_WALL_TISSUE;
    for (uint x = 0; x < l.columns; x += SV_LANES)
        *(__global float16 *)(confidence + x) = confidence_of(&l, *(__global const float16 *)(costs + x),
                                                              *(__global const float16 *)(confidence + x));
    for (uint x = 0; x < l.columns; x += LANES)
        find_own_fluid(&l, levels + x, rays, filtered + x, x / LANES, y, min((uint)LANES, l.columns - x));
}

/* One work item per row of cells: what its rays know of the surface. */
__kernel void wall_known(sv_wall_layout l, __global const uint *restrict info,
                         __global const ushort *restrict rays, __global const float *restrict planes,
                         __global uint4 *restrict rim) {
    const uint row = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    for (uint x = 0; x < l.cells[0]; x++)
        rim[(size_t)row * l.cells[0] + x] = mean_of_rays(&l, rays, planes, x, row);
}

/* One work item per row of rays: moves the surface in its range, to the far end at q = 0, to the near end at
 * q = 1, linear to either side of 0.5. From there it may go back. */
__kernel void wall_knob(sv_wall_layout l, __global const uint *restrict info,
                        __global const uchar *restrict levels, __global const ushort *restrict rays,
                        __global const ushort *restrict fine, __global const uint4 *restrict rim,
                        __global float *restrict planes) {
    const uint y = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const float part = fabs(2.0f * l.q - 1.0f);
    __global const float *filtered = planes + plane_row(&l, PLANE_MEDIAN, y);
    __global const float *end = planes + plane_row(&l, l.q < 0.5f ? PLANE_MEDIAN_FAR : PLANE_MEDIAN_NEAR, y);
    __global float *surface = planes + plane_row(&l, PLANE_SURFACE, y);
    for (uint x = 0; x < l.columns; x += SV_LANES) {
        const float16 place = *(__global const float16 *)(filtered + x);
        const float16 at = place + part * (*(__global const float16 *)(end + x) - place);
        *(__global float16 *)(surface + x) = fmax(at, 0.0f);
    }
    ROLLED_LOADS
    for (uint x = 0; x < l.columns; x++) {
        const bool own = rays[block_row(&l, RAY_FRONT, y) + x] != SV_WALL_NO_OWN_FLUID;
        const float place = own ? surface[x] : go_on(&l, levels, rays, fine, rim, planes, x, y, part);
        surface[x] = move_back(&l, levels, rays, x, y, place);
    }
}

/* Steps to the next pixel. There are at most twice as many rays as pixels. */
static void next_pixel(between_t *b, uint pixels, uint rays) {
    const int width = (int)(2 * pixels), rest = b->rest + (int)(2 * rays);
    const int passed = (rest >= width) + (rest >= 2 * width);
    b->rest = rest - passed * width;
    b->ray += passed;
}

/* Copies a row in which every pixel is a ray. */
static void copy_rays(const sv_wall_layout *l, __global const float *surface, __global const float *certainty,
                      float most, __global float *depth, __global float *confidence) {
    for (uint x = 0; x < l->width; x++) {
        depth[x] = (float)l->depth * surface[x];
        confidence[x] = most * fmin(certainty[x], 1.0f);
    }
}

/* One work item per row of pixels. The depthmap at q, from value `first` on; zeros if there is no surface. */
__kernel void wall_upsample(sv_wall_layout l, __global const uint *restrict info,
                            __global const float *restrict planes, __global float *restrict confidence,
                            ulong first, __global float *restrict depths) {
    const uint y = (uint)get_global_id(0);
    const bool wanted = info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE;
    const float most = most_confidence(&l, info);
    const pair_t v = pair_of(between(y, l.height, l.rows), l.height, l.rows);
    between_t at = between(0, l.width, l.columns);
    __global const float *surface = planes + plane_row(&l, PLANE_SURFACE, 0);
    depths += first + (size_t)y * l.width;
    confidence += (size_t)y * l.width;
    if (wanted && l.width == l.columns && l.height == l.rows) {
        copy_rays(&l, surface + plane_row(&l, 0, y), planes + plane_row(&l, 0, y), most, depths, confidence);
        return;
    }
    for (uint x = 0; x < l.width; x++) {
        const pair_t u = pair_of(at, l.width, l.columns);
        next_pixel(&at, l.width, l.columns);
        const float depth = (float)l.depth * interpolate(&l, surface, u, v);
        const float certainty = most * fmin(interpolate(&l, planes, u, v), 1.0f); /* weights are rounded */
        depths[x] = wanted ? depth : 0.0f;
        confidence[x] = wanted ? certainty : 0.0f;
    }
}
