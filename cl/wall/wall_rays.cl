/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, along the rays: how bright they are, their first tissue, and how bright that is where
 * it is the wall.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif

/* The first tissue of LANES rays, front to back. */
typedef struct {
    i16l begin, end; /* of the tissue */
    u8l begun, over; /* masks */
    u8l most;        /* brightest of it */
} walk_t;

static void step(walk_t *w, short z, u8l tissue, u8l bright) {
    const u8l begins = tissue & ~w->begun;
    if (some_bytes(begins)) w->begin = PICK(w->begin, (i16l)(z), words_of(begins));
    w->begun |= begins;
    const u8l ends = w->begun & ~tissue & ~w->over;
    if (some_bytes(ends)) w->end = PICK(w->end, (i16l)(z), words_of(ends));
    w->over |= ends;
    const u8l here = bright & w->begun & ~w->over;
    w->most = MOST(w->most, here);
}

/* Counts the rays that begin in the wall with fluid behind it, and how bright that is. */
static void count_walls(const walk_t *w, i16l first, i16l end, __global uint *histogram) {
    const i16l is_wall = words_of(w->begun) & (w->begin == first) & (w->end < end);
    if (!some_words(is_wall)) return;
    const uchar *most = (const uchar *)&w->most;
    const short *wall = (const short *)&is_wall;
    for (uint i = 0; i < LANES; i++) {
        histogram[HISTOGRAM_WALL_RAYS] += wall[i] != 0;
        histogram[most[i]] += wall[i] != 0;
    }
}

/* One work item per row of rays. `bright`: the largest of `beside` over the rows beside every ray. */
__kernel void wall_walls(sv_wall_layout l, __global const uint *restrict info,
                         __global const uchar *restrict levels, __global const uchar *restrict beside,
                         __global uchar *restrict bright, __global ushort *restrict rays,
                         __global uint *restrict histograms) {
    const uint row = (uint)get_global_id(0), vectors = vectors_of(&l);
    const uint from = row - min(row, l.beside[1]), to = min(row + l.beside[1], l.rows - 1);
    const u8l threshold = (u8l)((uchar)info[INFO_TISSUE]);
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    histograms += (size_t)row * HISTOGRAM_WORDS;
    for (uint i = 0; i < 256; i++) histograms[i] = 0;
    histograms[HISTOGRAM_WALL_RAYS] = 0;
    for (uint x = 0; x < vectors; x++) {
        const i16l first = AS_I16(ray_row(rays, &l, RAY_FIRST, row)[x]);
        const i16l end = AS_I16(ray_row(rays, &l, RAY_END, row)[x]);
        walk_t w = {.begin = end, .end = end, .begun = (u8l)(0), .over = (u8l)(0), .most = (u8l)(0)};
        for (uint z = 0; z < l.layers; z++) {
            u8l most = ((__global const u8l *)(beside + block_row(&l, z, from)))[x];
            for (uint y = from + 1; y <= to; y++) {
                const u8l other = ((__global const u8l *)(beside + block_row(&l, z, y)))[x];
                most = MOST(most, other);
            }
            ((__global u8l *)(bright + block_row(&l, z, row)))[x] = most;
            const u8l level = ((__global const u8l *)(levels + level_row(&l, z, row)))[x];
            step(&w, (short)z, AS_U8(level > threshold), most);
        }
        ray_row(rays, &l, RAY_RUN, row)[x] = AS_U16(w.begin);
        ray_row(rays, &l, RAY_RUN_END, row)[x] = AS_U16(w.end);
        count_walls(&w, first, end, histograms);
    }
}
