/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, along the rays: what of them is tissue, their first tissue, and how bright it is where
 * it is the wall.
 */
#ifndef SV_WALL_CLH
#include "wall/wall.clh"
#endif

/* LANES rays from their ends to their fronts: the run of tissue that was met last. */
typedef struct {
    i16l first, end;     /* scanned slices */
    i16l begin, run_end; /* of the run */
    i16l fluid;          /* slices of fluid behind it */
    u8l most;            /* brightest of it */
    i16l some;           /* there is a run */
} walk_t;

/* Front to back: in place of every voxel the length of the tissue up to it. */
static void mark_runs(const sv_wall_layout *l, __global u8l *voxels, size_t plane, uchar threshold) {
    u8l run = (u8l)(0);
    for (uint z = 0; z < l->slices; z++) {
        const u8l bright = AS_U8(voxels[z * plane] > (u8l)(threshold));
        run = longer(run) & bright;
        voxels[z * plane] = run;
    }
}

/* Back to front: a mask of tissue in place of the lengths, without what is too thin; and the first run. */
static void walk_back(const sv_wall_layout *l, __global u8l *voxels, __global const u8l *bright, size_t plane,
                      walk_t *w) {
    const u8l thin = (u8l)((uchar)l->thin);
    u8l tissue = (u8l)(0);
    w->begin = w->run_end = w->end;
    w->fluid = w->some = (i16l)(0);
    w->most = (u8l)(0);
    for (uint z = l->slices; z-- > 0;) {
        const u8l run = voxels[z * plane], behind = tissue;
        tissue = AS_U8(run > (u8l)(0)) & (AS_U8(run >= thin) | behind);
        voxels[z * plane] = tissue;
        if (!some_bytes(tissue)) continue;
        const i16l at = (i16l)((short)z), in = words_of(tissue);
        const u8l enters = tissue & ~behind;
        if (some_bytes(enters)) {
            const i16l fresh = words_of(enters);
            w->fluid = PICK(w->fluid, w->begin - at - (short)1, fresh);
            w->run_end = PICK(w->run_end, at + (short)1, fresh);
            w->some |= fresh;
            w->most &= ~enters;
        }
        w->begin = PICK(w->begin, at, in);
        const u8l here = bright[z * plane] & tissue;
        w->most = MOST(w->most, here);
    }
}

/* Counts the rays that begin in the wall with fluid behind it, and how bright that is. */
static void count_walls(const sv_wall_layout *l, const walk_t *w, __global uint *histogram) {
    const i16l gap = (i16l)((short)l->gap);
    const i16l is_wall = w->some & (w->begin - w->first < gap) & (w->fluid >= gap);
    const uchar *most = (const uchar *)&w->most;
    const short *wall = (const short *)&is_wall;
    for (uint i = 0; i < LANES; i++) {
        histogram[HISTOGRAM_WALL_RAYS] += wall[i] != 0;
        histogram[most[i]] += wall[i] != 0;
    }
}

/* One work item per row: `voxels` become masks of tissue. */
__kernel void wall_walls(sv_wall_layout l, __global const uint *restrict info,
                         __global const u8l *restrict bright, __global u8l *restrict voxels,
                         __global ushort *restrict rays, __global uint *restrict histograms) {
    const uint y = (uint)get_global_id(0), vectors = padded_width_of(&l) / LANES;
    const size_t plane = (size_t)vectors * l.height, row = (size_t)y * vectors;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    histograms += (size_t)y * HISTOGRAM_WORDS;
    for (uint i = 0; i < 256; i++) histograms[i] = 0;
    histograms[HISTOGRAM_WALL_RAYS] = 0;
    for (uint x = 0; x < vectors; x++) {
        walk_t w;
        w.first = AS_I16(ray_row(rays, &l, RAY_FIRST, y)[x]);
        w.end = AS_I16(ray_row(rays, &l, RAY_END, y)[x]);
        mark_runs(&l, voxels + row + x, plane, (uchar)info[INFO_THRESHOLD]);
        walk_back(&l, voxels + row + x, bright + row + x, plane, &w);
        ray_row(rays, &l, RAY_RUN, y)[x] = AS_U16(w.begin);
        ray_row(rays, &l, RAY_RUN_END, y)[x] = AS_U16(w.run_end);
        count_walls(&l, &w, histograms);
    }
}
