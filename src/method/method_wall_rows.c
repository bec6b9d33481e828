/* SPDX-License-Identifier: MIT */
#include "method/method_wall.h"

#include "kernels_wall.h"
#include "method/method.h"

/* clang-format off */
#define KERNELS(KERNEL) \
    KERNEL(SCANNED, "scanned_planes") \
    KERNEL(DOWNSAMPLE, "wall_downsample") \
    KERNEL(BLOCKS, "wall_blocks") \
    KERNEL(GATHER, "wall_gather") \
    KERNEL(SMOOTH, "wall_smooth") \
    KERNEL(LEVELS, "wall_levels") \
    KERNEL(BRIGHT, "wall_bright") \
    KERNEL(RELATIVE, "wall_relative") \
    KERNEL(FIRST_RUNS, "wall_first_runs") \
    KERNEL(EVIDENCE, "wall_evidence") \
    KERNEL(SURROUNDINGS, "wall_surroundings") \
    KERNEL(BETWEEN, "wall_between") \
    KERNEL(FLOATING, "wall_floating") \
    KERNEL(MARK_CELLS, "wall_mark_cells") \
    KERNEL(SKIP_NEAR, "wall_skip_near") \
    KERNEL(COSTS, "wall_costs") \
    KERNEL(DECIDE, "wall_decide") \
    KERNEL(BLUR, "wall_blur") \
    KERNEL(MINIMUM, "wall_minimum") \
    KERNEL(MEDIAN, "wall_median") \
    KERNEL(GAPS, "wall_gaps") \
    KERNEL(VERDICT, "wall_verdict") \
    KERNEL(CONFIDENCE, "wall_confidence") \
    KERNEL(ERODE, "wall_erode") \
    KERNEL(OPEN, "wall_open") \
    KERNEL(KNOWN, "wall_known") \
    KERNEL(RIM, "wall_rim") \
    KERNEL(KNOB, "wall_knob") \
    KERNEL(UPSAMPLE, "wall_upsample")
/* clang-format on */
#define PLACE(key, name) K_##key,
#define NAME(key, name)  name,
enum { KERNELS(PLACE) K_COUNT };
const char *const sv_wall_rows_kernels[] = {KERNELS(NAME) NULL};
_Static_assert(K_SCANNED == SV_METHOD_SCANNED, "the frame finds it");

sv_source sv_wall_rows_source(void) {
    return (sv_source){sv_kernels_wall, sv_kernels_wall_size};
}

static sv_status slabs(const sv_map *m, sv_method_state *s, const sv_placed_slabs *from) {
    const sv_wall_layout layout = sv_wall_own_of(s)->camera;
    sv_launch l = sv_slabs_launch(m, s->kernels.kernel[K_DOWNSAMPLE], sv_wall_rows_kernels[K_DOWNSAMPLE],
                                  from, s->buffer[SV_WALL_PLANES]);
    sv_launch_arg(&l, sizeof layout, &layout);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SPANS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SUMS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_RANGES]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_LEVELS]);
    return sv_launch_items(&l, layout.cells[1], SV_STAGE_PROFILE);
}

static sv_status gather(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid) {
    const sv_wall_own *const own = sv_wall_own_of(s);
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_GATHER], sv_wall_rows_kernels[K_GATHER]);
    sv_launch_arg(&l, sizeof own->beams, &own->beams);
    sv_launch_arg(&l, sizeof *grid, grid);
    sv_launch_uint(&l, own->beam_words);
    sv_launch_buffer(&l, s->buffer[SV_WALL_TABLES]);
    sv_launch_buffer(&l, s->buffer[own->camera.smoothed ? SV_WALL_SMOOTHED : SV_WALL_LEVELS]);
    static const int outputs[] = {SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_SCRATCH, SV_WALL_ROW_MAXIMA,
                                  SV_WALL_HISTOGRAMS};
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        sv_launch_buffer(&l, s->buffer[SV_WALL_BEAMS + outputs[i]]);
    return sv_launch_items(&l, own->beams.cells[1], SV_STAGE_THRESHOLD);
}

static const sv_wall_launch launches[] = {
    {K_BLOCKS, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_SPANS, SV_WALL_RANGES, SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 SV_WALL_ROW_MAXIMA, SV_WALL_HISTOGRAMS, -1},
     .takes = SV_WALL_BOUNDS | SV_WALL_SCRATCH_WORDS},
    {K_SMOOTH, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_SMOOTHED, SV_WALL_HISTOGRAMS, -1},
     .when = SV_WALL_IF_SMOOTHED},
    {K_LEVELS, SV_WALL_ONCE, .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {K_BRIGHT, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_RAYS, SV_WALL_SCRATCH, SV_WALL_WINDOWS, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_RELATIVE, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_WINDOWS, SV_WALL_SMOOTHED, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 SV_WALL_RELATIVE, SV_WALL_FRONTS, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_FIRST_RUNS, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_SCRATCH, SV_WALL_RELATIVE, SV_WALL_ROW_MAXIMA,
                 SV_WALL_BRIGHT, SV_WALL_RAYS, SV_WALL_HISTOGRAMS, SV_WALL_FLAGS, SV_WALL_FRONTS, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_BETWEEN, SV_WALL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_LEVELS, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_LIMBS, -1},
     .when = SV_WALL_FOR_BEAMS},
    {K_FLOATING, SV_WALL_ALL_LAYERS, .buffers = {SV_WALL_LIMBS, -1}, .when = SV_WALL_FOR_BEAMS},
    {K_EVIDENCE, SV_WALL_ONCE, .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {K_SURROUNDINGS, SV_WALL_WORDS, .buffers = {SV_WALL_INFO, SV_WALL_BRIGHT, SV_WALL_FLAGS, -1}},
    {K_COSTS, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_BRIGHT, SV_WALL_FLAGS, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 SV_WALL_COSTS, SV_WALL_FETUS, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_DECIDE, SV_WALL_ONCE, .buffers = {SV_WALL_FETUS, SV_WALL_TOLD, SV_WALL_INFO, -1}},
    {K_BLUR, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_COSTS, SV_WALL_RAYS, SV_WALL_SCRATCH, SV_WALL_FINE, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_MINIMUM, SV_WALL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_FINE, SV_WALL_RAYS, SV_WALL_SCRATCH, SV_WALL_PLANES, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_MEDIAN, SV_WALL_ROWS, .buffers = {SV_WALL_INFO, SV_WALL_PLANES, -1}},
    {K_GAPS, SV_WALL_CELL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_PLANES, SV_WALL_GAPS,
                 -1},
     .when = SV_WALL_UNLESS_TOLD},
    {K_VERDICT, SV_WALL_ONCE, .buffers = {SV_WALL_GAPS, SV_WALL_TOLD, SV_WALL_INFO, -1},
     .takes = SV_WALL_RECORD},
    {K_CONFIDENCE, SV_WALL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_PLANES, -1}},
    {K_ERODE, SV_WALL_ROWS, .buffers = {SV_WALL_INFO, SV_WALL_RAYS, SV_WALL_SCRATCH, SV_WALL_PLANES, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_OPEN, SV_WALL_ROWS, .buffers = {SV_WALL_INFO, SV_WALL_SCRATCH, SV_WALL_PLANES, -1},
     .takes = SV_WALL_SCRATCH_WORDS},
    {K_KNOWN, SV_WALL_CELL_ROWS, .buffers = {SV_WALL_INFO, SV_WALL_RAYS, SV_WALL_PLANES, SV_WALL_RIM, -1}},
    {K_RIM, SV_WALL_ONCE, .buffers = {SV_WALL_INFO, SV_WALL_RIM, -1}},
    {K_KNOB, SV_WALL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_FINE, SV_WALL_RIM, SV_WALL_PLANES,
                 -1}},
    {K_UPSAMPLE, SV_WALL_PIXEL_ROWS, .buffers = {SV_WALL_INFO, SV_WALL_PLANES, SV_WALL_CONFIDENCE, -1},
     .takes = SV_WALL_DEPTH},
};
enum { COUNT = sizeof launches / sizeof *launches };

const sv_wall_work sv_wall_rows = {.kernels = sv_wall_rows_kernels,
                                   .slabs = slabs,
                                   .gather = gather,
                                   .mark = K_MARK_CELLS,
                                   .skip = K_SKIP_NEAR,
                                   .launches = launches,
                                   .count = COUNT,
                                   .reconstructs = 10,
                                   .first_at_q = COUNT - 2,
                                   .gathered = 2,
                                   .near = 5,
                                   .verdict = 16,
                                   .floated = 8,
                                   .surrounded = 10};
