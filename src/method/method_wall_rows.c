/* SPDX-License-Identifier: MIT */
#include "method/method_wall_rows.h"

#include "kernels_wall.h"
#include "method/method_slabs.h"

enum {
    K_TAKE,
    K_BLOCKS,
    K_STEADY,
    K_LEVELS,
    K_WALLS,
    K_EVIDENCE,
    K_AROUND,
    K_COSTS,
    K_DECIDE,
    K_BLUR,
    K_CHEAPEST,
    K_MEDIAN,
    K_TRUST,
    K_TURN,
    K_LEAVE
};
const char *const sv_wall_rows_kernels[] = {"wall_take",   "wall_blocks",   "wall_steady",   "wall_levels",
                                            "wall_walls",  "wall_evidence", "wall_around",   "wall_costs",
                                            "wall_decide", "wall_blur",     "wall_cheapest", "wall_median",
                                            "wall_trust",  "wall_turn",     "wall_leave",    NULL};

sv_source sv_wall_rows_source(void) {
    return (sv_source){sv_kernels_wall, sv_kernels_wall_size};
}

static sv_status slab(const sv_map *m, sv_method_state *s, const sv_placed_slab *from,
                      const sv_wall_layout *layout) {
    sv_launch l = sv_slab_launch(m, s->kernels.kernel[K_TAKE], sv_wall_rows_kernels[K_TAKE], from,
                                 s->buffer[SV_WALL_PLACES]);
    sv_launch_arg(&l, sizeof *layout, layout);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SPANS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SUMS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_RANGES]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_LEVELS]);
    return sv_launch_items(&l, layout->cells[1], SV_STAGE_PROFILE);
}

static const sv_wall_launch launches[] = {
    {.kernel = K_BLOCKS,
     .takes = SV_WALL_BOUNDS | SV_WALL_SCRATCH_WORDS,
     .over = SV_WALL_CELL_ROWS,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_SPANS, SV_WALL_RANGES, SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 SV_WALL_LARGEST, SV_WALL_HISTOGRAMS, -1}},
    {.kernel = K_STEADY,
     .over = SV_WALL_CELL_ROWS,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_STEADIED, SV_WALL_HISTOGRAMS, -1},
     .when = SV_WALL_IF_STEADIED},
    {.kernel = K_LEVELS,
     .over = SV_WALL_ONCE,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {.kernel = K_WALLS,
     .over = SV_WALL_CELL_ROWS,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_INFO, SV_WALL_STEADIED, SV_WALL_LARGEST, SV_WALL_BRIGHT, SV_WALL_RAYS,
                 SV_WALL_HISTOGRAMS, SV_WALL_KINDS, -1}},
    {.kernel = K_EVIDENCE,
     .over = SV_WALL_ONCE,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {.kernel = K_AROUND,
     .over = SV_WALL_WORDS,
     .stage = SV_STAGE_THRESHOLD,
     .buffers = {SV_WALL_INFO, SV_WALL_BRIGHT, SV_WALL_KINDS, -1}},
    {.kernel = K_COSTS,
     .takes = SV_WALL_SCRATCH_WORDS,
     .over = SV_WALL_CELL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_STEADIED, SV_WALL_BRIGHT, SV_WALL_KINDS, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 SV_WALL_COSTS, SV_WALL_AWAYS, SV_WALL_FETUS, -1}},
    {.kernel = K_DECIDE,
     .takes = SV_WALL_RECORD,
     .over = SV_WALL_ONCE,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_FETUS, SV_WALL_INFO, -1}},
    {.kernel = K_BLUR,
     .takes = SV_WALL_SCRATCH_WORDS,
     .over = SV_WALL_CELL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_COSTS, SV_WALL_SCRATCH, SV_WALL_FINE, -1}},
    {.kernel = K_CHEAPEST,
     .takes = SV_WALL_SCRATCH_WORDS,
     .over = SV_WALL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_FINE, SV_WALL_SCRATCH, SV_WALL_PLACES, -1}},
    {.kernel = K_MEDIAN,
     .over = SV_WALL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_COSTS, SV_WALL_AWAYS, SV_WALL_PLACES, -1}},
    {.kernel = K_TRUST,
     .over = SV_WALL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_PLACES, -1}},
    {.kernel = K_TURN,
     .over = SV_WALL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_STEADIED, SV_WALL_RAYS, SV_WALL_PLACES, -1}},
    {.kernel = K_LEAVE,
     .takes = SV_WALL_SURFACES,
     .over = SV_WALL_PIXEL_ROWS,
     .stage = SV_STAGE_RECONSTRUCT,
     .buffers = {SV_WALL_INFO, SV_WALL_PLACES, SV_WALL_CONFIDENCE, -1}},
};
enum { COUNT = sizeof launches / sizeof *launches };

const sv_wall_work sv_wall_rows = {.kernels = sv_wall_rows_kernels,
                                   .slab = slab,
                                   .launches = launches,
                                   .count = COUNT,
                                   .first_of_turn = COUNT - 2};
