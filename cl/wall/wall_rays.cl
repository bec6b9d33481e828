/* SPDX-License-Identifier: MIT */
/*
 * The wall's surface, along the rays: how bright they are, their first tissue, and how bright that is where
 * it is the wall; then what is around tissue.
 */
#ifndef SV_WALL_LANES_CLH
#include "wall/wall_lanes.clh"
#endif
#ifndef SV_WALL_SURROUNDINGS_CLH
#include "wall/wall_surroundings.clh"
#endif

/* The first tissue of LANES rays, front to back. */
typedef struct {
    i16l begin, end; /* of the tissue */
    u8l begun, over; /* masks */
    u8l most;        /* brightest of it */
} walk_t;

static void step(walk_t *w, short z, u8l tissue, u8l bright) {
    const u8l begins = tissue & ~w->begun;
    if (any_byte(begins)) w->begin = SELECT(w->begin, (i16l)(z), words_of(begins));
    w->begun |= begins;
    const u8l ends = w->begun & ~tissue & ~w->over;
    if (any_byte(ends)) w->end = SELECT(w->end, (i16l)(z), words_of(ends));
    w->over |= ends;
    const u8l here = bright & w->begun & ~w->over;
    w->most = MAXIMUM(w->most, here);
}

/* Counts the rays that begin in the wall with fluid behind it, and how bright that is. */
static void count_walls(const walk_t *w, i16l first, i16l end, __global uint *histogram) {
    const i16l is_wall = words_of(w->begun) & (w->begin == first) & (w->end < end);
    if (!any_word(is_wall)) return;
    const uchar *most = (const uchar *)&w->most;
    const short *wall = (const short *)&is_wall;
    for (uint i = 0; i < LANES; i++) {
        histogram[HISTOGRAM_WALL_RAYS] += wall[i] != 0;
        histogram[most[i]] += wall[i] != 0;
    }
}

/* The largest of a row of layer `z` and of the rows of cells beside it. */
static void brightest(const sv_wall_layout *l, __global const uchar *beside, uint z, uint row,
                      __global uchar *bright) {
    const uint from = row - min(row, l->dilation[1]), to = min(row + l->dilation[1], l->cells[1] - 1);
    for (uint x = 0; x < padded_cells_of(l) / LANES; x++) {
        u8l most = ((__global const u8l *)(beside + cell_row(l, z, from)))[x];
        for (uint y = from + 1; y <= to; y++) {
            const u8l other = ((__global const u8l *)(beside + cell_row(l, z, y)))[x];
            most = MAXIMUM(most, other);
        }
        ((__global u8l *)(bright + cell_row(l, z, row)))[x] = most;
    }
}

/* LANES rays, up to where the first tissue of the last of them ends. */
static walk_t walk_rays(const sv_wall_layout *l, __global const uchar *levels, __global const uchar *bright,
                        uint row, uint x, u8l threshold, i16l end) {
    walk_t w = {.begin = end, .end = end, .begun = (u8l)(0), .over = (u8l)(0), .most = (u8l)(0)};
    const u8l scanned = bytes_of(end > (i16l)(0));
    for (uint z = 0; z < l->layers && any_byte(scanned & ~w.over); z++) {
        const u8l level = ((__global const u8l *)(levels + level_row(l, z, row)))[x];
        const u8h cells = ((__global const u8h *)(bright + cell_row(l, z, row / 2)))[x];
        step(&w, (short)z, AS_U8(level > threshold), rays_of_cells(cells));
    }
    return w;
}

/* One work item per row of cells. `bright`: the largest of `beside` over the rows beside every cell. */
__kernel void wall_first_runs(sv_wall_layout l, __global const uint *restrict info,
                              __global const uchar *restrict levels, __global const uchar *restrict beside,
                              __global uchar *restrict bright, __global ushort *restrict rays,
                              __global uint *restrict histograms, __global ulong *restrict kinds) {
    const uint row = (uint)get_global_id(0);
    const u8l threshold = (u8l)((uchar)info[INFO_TISSUE]);
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    histograms += (size_t)row * HISTOGRAM_WORDS;
    for (uint i = 0; i < 256; i++) histograms[i] = 0;
    histograms[HISTOGRAM_WALL_RAYS] = 0;
    for (uint z = 0; z < l.layers; z++) brightest(&l, beside, z, row, bright);
    for (uint line = 2 * row; line < 2 * row + 2; line++)
        for (uint x = 0; x < vectors_of(&l); x++) {
            const i16l first = AS_I16(ray_row(rays, &l, RAY_FIRST, line)[x]);
            const i16l end = AS_I16(ray_row(rays, &l, RAY_END, line)[x]);
            const walk_t w = walk_rays(&l, levels, bright, line, x, threshold, end);
            ray_row(rays, &l, RAY_RUN, line)[x] = AS_U16(w.begin);
            ray_row(rays, &l, RAY_RUN_END, line)[x] = AS_U16(w.end);
            count_walls(&w, first, end, histograms);
        }
    classify_row(&l, levels, rays, row, threshold, kinds);
}

/* One work item per word of cells of a row and SV_WALL_LAYERS layers: what the cells of its column are, but
 * for what is beside the fetus in their rows. */
__kernel void wall_surroundings(sv_wall_layout l, __global const uint *restrict info,
                                __global const uchar *restrict bright, __global ulong *restrict kinds) {
    const uint word = (uint)get_global_id(0) % words_of_row(&l),
               z = (uint)get_global_id(0) / words_of_row(&l) * SV_WALL_LAYERS;
    if (info[INFO_OUTCOME] != SV_WALL_SURFACE) return;
    sweep_columns(&l, bright, info[INFO_FETUS], word, z, kinds + word_column(&l, 0, word) + z,
                  word_column(&l, 1, 0));
}
