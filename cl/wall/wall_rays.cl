/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, along the rays: what of them is tissue, their first tissue, and how bright it is where
 * it is the wall.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* 16 rays from their ends to their fronts: the run of tissue that was met last. */
typedef struct {
    short16 first, end;     /* scanned slices */
    short16 begin, run_end; /* of the run */
    short16 fluid;          /* slices of fluid behind it */
    uchar16 most;           /* brightest of it */
    short16 some;           /* there is a run */
} walk_t;

/* Front to back: in place of every voxel the length of the tissue up to it. */
static void mark_runs(const sv_wall_layout *l, __global uchar16 *voxels, size_t plane, uchar threshold) {
    uchar16 run = (uchar16)(0);
    for (uint z = 0; z < l->slices; z++) {
        const uchar16 bright = as_uchar16(voxels[z * plane] > (uchar16)(threshold));
        run = longer(run) & bright;
        voxels[z * plane] = run;
    }
}

/* Back to front: a mask of tissue in place of the lengths, without what is too thin; and the first run. */
static void walk_back(const sv_wall_layout *l, __global uchar16 *voxels, __global const uchar16 *bright,
                      size_t plane, walk_t *w) {
    const uchar16 thin = (uchar16)((uchar)l->thin);
    uchar16 tissue = (uchar16)(0);
    w->begin = w->run_end = w->end;
    w->fluid = w->some = (short16)(0);
    w->most = (uchar16)(0);
    for (uint z = l->slices; z-- > 0;) {
        const uchar16 run = voxels[z * plane], behind = tissue;
        tissue = as_uchar16(run > (uchar16)(0)) & (as_uchar16(run >= thin) | behind);
        voxels[z * plane] = tissue;
        if (!some_bytes(tissue)) continue;
        const short16 at = (short16)((short)z), in = words_of(tissue);
        const uchar16 enters = tissue & ~behind;
        if (some_bytes(enters)) {
            const short16 fresh = words_of(enters);
            w->fluid = select(w->fluid, w->begin - at - (short)1, fresh);
            w->run_end = select(w->run_end, at + (short)1, fresh);
            w->some |= fresh;
            w->most &= ~enters;
        }
        w->begin = select(w->begin, at, in);
        w->most = max(w->most, bright[z * plane] & tissue);
    }
}

/* Counts the rays that begin in the wall with fluid behind it, and how bright that is. */
static void count_walls(const sv_wall_layout *l, const walk_t *w, __global uint *histogram) {
    const short16 gap = (short16)((short)l->gap);
    const short16 is_wall = w->some & (w->begin - w->first < gap) & (w->fluid >= gap);
    const uchar *most = (const uchar *)&w->most;
    const short *wall = (const short *)&is_wall;
    for (uint i = 0; i < SV_LANES; i++) {
        histogram[HISTOGRAM_WALL_RAYS] += wall[i] != 0;
        histogram[most[i]] += wall[i] != 0;
    }
}

/* One work item per row: `voxels` become masks of tissue. */
__kernel void wall_walls(sv_wall_layout l, __global const uint *restrict info,
                         __global const uchar16 *restrict bright, __global uchar16 *restrict voxels,
                         __global ushort16 *restrict rays, __global uint *restrict histograms) {
    const uint y = (uint)get_global_id(0), vectors = padded_width_of(&l) / SV_LANES;
    const size_t plane = (size_t)vectors * l.height, row = (size_t)y * vectors;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    histograms += (size_t)y * HISTOGRAM_WORDS;
    for (uint i = 0; i < 256; i++) histograms[i] = 0;
    histograms[HISTOGRAM_WALL_RAYS] = 0;
    for (uint x = 0; x < vectors; x++) {
        walk_t w;
        w.first = as_short16(ray_row(rays, &l, RAY_FIRST, y)[x]);
        w.end = as_short16(ray_row(rays, &l, RAY_END, y)[x]);
        mark_runs(&l, voxels + row + x, plane, (uchar)info[INFO_THRESHOLD]);
        walk_back(&l, voxels + row + x, bright + row + x, plane, &w);
        ray_row(rays, &l, RAY_RUN, y)[x] = as_ushort16(w.begin);
        ray_row(rays, &l, RAY_RUN_END, y)[x] = as_ushort16(w.run_end);
        count_walls(&l, &w, histograms);
    }
}
