/* SPDX-License-Identifier: MIT */
/*
 * Along the rays: the brightness of cells, the first run of each ray, and the brightness of the wall; then
 * what surrounds tissue.
 */
#ifndef SV_WALL_SURROUNDINGS_CLH
#include "wall/wall_surroundings.clh"
#endif
#ifndef SV_WALL_VALLEYS_CLH
#include "wall/wall_valleys.clh"
#endif

/* The first run of LANES rays, found from front to back. */
typedef struct {
    i16l begin, end;   /* of the run */
    u8l seen, ended;   /* masks */
    u8l maximum, last; /* its maximum brightness behind the skin, and that of its last layer */
} walk_t;

static void walk_step(walk_t *w, short z, short skin, u8l tissue, u8l brightness) {
    const u8l begins = tissue & ~w->seen;
    if (any_byte(begins)) w->begin = SELECT(w->begin, (i16l)(z), words_of(begins));
    w->seen |= begins;
    const u8l ends = w->seen & ~tissue & ~w->ended;
    if (any_byte(ends)) w->end = SELECT(w->end, (i16l)(z), words_of(ends));
    w->ended |= ends;
    const u8l in_run = w->seen & ~w->ended, here = brightness & in_run;
    const u8l behind_skin = here & bytes_of(w->begin <= (i16l)((short)(z - skin)));
    w->maximum = MAXIMUM(w->maximum, behind_skin);
    w->last = SELECT(w->last, here, AS_I8(in_run));
}

/* Counts the rays that begin in the wall with fluid behind it, by the brightness of the wall. */
static void count_walls(const sv_wall_layout *l, const walk_t *w, i16l first, i16l end,
                        __global uint *histogram) {
    const i16l is_wall = words_of(w->seen) & (w->begin == first) & (w->end < end);
    if (!any_word(is_wall)) return;
    const u8l thin = bytes_of(w->end - w->begin <= (i16l)((short)l->skin));
    const u8l maxima = SELECT(w->maximum, w->last, AS_I8(thin));
    const uchar *maximum = (const uchar *)&maxima;
    const short *wall = (const short *)&is_wall;
    for (uint i = 0; i < LANES; i++) {
        histogram[HISTOGRAM_WALL_RAYS] += wall[i] != 0;
        histogram[maximum[i]] += wall[i] != 0;
    }
}

/* Grey dilation along y: the maximum of a row of layer `z` and of the rows of cells near it. */
static void dilate_columns(const sv_wall_layout *l, __global const uchar *row_maxima, uint z, uint row,
                           __global uchar *brightness) {
    const uint from = row - min(row, l->dilation[1]), to = min(row + l->dilation[1], l->cells[1] - 1);
    for (uint x = 0; x < padded_cells_of(l) / LANES; x++) {
        u8l maximum = ((__global const u8l *)(row_maxima + cell_row(l, z, from)))[x];
        for (uint y = from + 1; y <= to; y++) {
            const u8l next = ((__global const u8l *)(row_maxima + cell_row(l, z, y)))[x];
            maximum = MAXIMUM(maximum, next);
        }
        ((__global u8l *)(brightness + cell_row(l, z, row)))[x] = maximum;
    }
}

/* Walks LANES rays from layer `from` on, until the first run of the last of them ends. */
static walk_t walk_rays(const sv_wall_layout *l, __global const uchar *levels,
                        __global const uchar *brightness, uint row, uint x, uint from, i16l end) {
    walk_t w = {
        .begin = end, .end = end, .seen = (u8l)(0), .ended = (u8l)(0), .maximum = (u8l)(0), .last = (u8l)(0)};
    const u8l scanned = bytes_of(end > (i16l)(0));
    for (uint z = from; z < l->layers && any_byte(scanned & ~w.ended); z++) {
        const u8l level = ((__global const u8l *)(levels + level_row(l, z, row)))[x];
        const u8h cells = ((__global const u8h *)(brightness + cell_row(l, z, row / 2)))[x];
        walk_step(&w, (short)z, (short)l->skin, tissue_of(level), rays_of_cells(cells));
    }
    return w;
}

/* Dim blocks at the start of LANES rays' scans, none of them in front of layer `from`, are tissue. */
static void fill_dim_fronts(const sv_wall_layout *l, __global uchar *relative, uint from, i16l first,
                            i16l end) {
    const size_t pitch = level_pitch_of(l);
    i16l open = end > first;
    for (uint z = from; z < l->layers && any_word(open); z++) {
        const i16l at = (i16l)((short)z), scanned = (first <= at) & (end > at);
        __global u8l *here = (__global u8l *)(relative + z * pitch);
        const u8l level = *here;
        const u8l is_dim = AS_U8(level > (u8l)((uchar)l->dim)) & ~tissue_of(level);
        const i16l fills = words_of(is_dim) & scanned & open;
        if (any_word(fills)) *here = SELECT(level, (u8l)((uchar)SV_WALL_DIM_TISSUE), AS_I8(bytes_of(fills)));
        open &= fills | (first > at);
    }
}

/* One work item per row of cells. `levels`: relative ones, of `grey`; `brightness`: the dilation of
 * `row_maxima` along y. */
__kernel void wall_first_runs(sv_wall_layout l, uint scratch_words, __global const uint *restrict info,
                              __global const uchar *restrict grey, __global uint *restrict scratch,
                              __global uchar *restrict levels, __global const uchar *restrict row_maxima,
                              __global uchar *restrict brightness, __global ushort *restrict rays,
                              __global uint *restrict histograms, __global ulong *restrict flags,
                              __global const uint *restrict fronts) {
    const uint row = (uint)get_global_id(0);
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    const bool near_field = has_near_field(&l, fronts, info[SV_WALL_INFO_RAYS]);
    histograms += (size_t)row * HISTOGRAM_WORDS;
    for (uint i = 0; i < 256; i++) histograms[i] = 0;
    histograms[HISTOGRAM_WALL_RAYS] = 0;
    const extent_t in_row = extent_of_row(&l, rays, row);
    for (uint z = in_row.from; z < in_row.to; z++) dilate_columns(&l, row_maxima, z, row, brightness);
    for (uint line = 2 * row; line < 2 * row + 2; line++)
        for (uint x = 0; x < vectors_of(&l); x++) {
            const i16l end = AS_I16(ray_row(rays, &l, RAY_END, line)[x]);
            __global uchar *const from = levels + level_row(&l, 0, line) + x * LANES;
            i16l first = AS_I16(ray_row(rays, &l, RAY_FIRST, line)[x]);
            if (near_field) first = behind_near_field(&l, from, in_row.from, first, end);
            fill_dim_fronts(&l, from, in_row.from, first, end);
            part_valleys(&l, grey, from, line, x, in_row.from, first, end,
                         scratch + (size_t)row * scratch_words);
            const walk_t w = walk_rays(&l, levels, brightness, line, x, in_row.from, end);
            ray_row(rays, &l, RAY_FIRST, line)[x] = AS_U16(first);
            ray_row(rays, &l, RAY_RUN, line)[x] = AS_U16(w.begin);
            ray_row(rays, &l, RAY_RUN_END, line)[x] = AS_U16(w.end);
            count_walls(&l, &w, first, end, histograms);
        }
    classify_row(&l, levels, rays, row, in_row, flags);
}

/* One work item per word of cells of a row and SV_WALL_LAYERS layers. It finds the flags of the cells of its
 * columns, but for what the fetus reaches in their rows. */
__kernel void wall_surroundings(sv_wall_layout l, __global const uint *restrict info,
                                __global const uchar *restrict brightness, __global ulong *restrict flags) {
    const uint word = (uint)get_global_id(0) % words_of_row(&l),
               z = (uint)get_global_id(0) / words_of_row(&l) * SV_WALL_LAYERS;
    if (info[SV_WALL_INFO_OUTCOME] != SV_WALL_SURFACE) return;
    sweep_columns(&l, brightness, info[SV_WALL_INFO_FETUS], word, z, flags + word_column(&l, 0, word) + z,
                  word_column(&l, 1, 0));
}
