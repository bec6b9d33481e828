/* SPDX-License-Identifier: MIT */
#include "method/method_wall.h"

#include "kernels_wall_items.h"
#include "method/method.h"

/* clang-format off */
#define KERNELS(KERNEL) \
    KERNEL(SCANNED, "scanned_planes") \
    KERNEL(RANGE, "wall_items_range") \
    KERNEL(DOWNSAMPLE, "wall_items_downsample") \
    KERNEL(BLOCKS, "wall_items_blocks") \
    KERNEL(GATHER, "wall_items_gather") \
    KERNEL(SMOOTH, "wall_items_smooth") \
    KERNEL(DILATE_ROWS, "wall_items_dilate_rows") \
    KERNEL(LEVELS, "wall_levels") \
    KERNEL(DILATE_COLUMNS, "wall_items_dilate_columns") \
    KERNEL(BRIGHT, "wall_items_bright") \
    KERNEL(BRIGHT_ROWS, "wall_items_bright_rows") \
    KERNEL(RELATIVE, "wall_items_relative") \
    KERNEL(NEAR_FIELD, "wall_items_near_field") \
    KERNEL(FIRST_RUNS, "wall_items_first_runs") \
    KERNEL(EVIDENCE, "wall_evidence") \
    KERNEL(SURROUNDINGS, "wall_items_surroundings") \
    KERNEL(BETWEEN, "wall_between") \
    KERNEL(FLOATING, "wall_floating") \
    KERNEL(MARK_CELLS, "wall_mark_cells") \
    KERNEL(SKIP_NEAR, "wall_skip_near") \
    KERNEL(COSTS, "wall_items_costs") \
    KERNEL(CELLS, "wall_items_cells") \
    KERNEL(DECIDE, "wall_decide") \
    KERNEL(BLUR_Y, "wall_items_blur_y") \
    KERNEL(BLUR_X, "wall_items_blur_x") \
    KERNEL(MINIMUM, "wall_items_minimum") \
    KERNEL(MEDIAN, "wall_items_median") \
    KERNEL(GAPS, "wall_items_gaps") \
    KERNEL(VERDICT, "wall_verdict") \
    KERNEL(CONFIDENCE, "wall_items_confidence") \
    KERNEL(ERODE, "wall_items_erode") \
    KERNEL(OPEN, "wall_items_open") \
    KERNEL(KNOWN, "wall_items_known") \
    KERNEL(RIM, "wall_rim") \
    KERNEL(KNOB, "wall_items_knob") \
    KERNEL(UPSAMPLE, "wall_items_upsample")
/* clang-format on */
#define PLACE(key, name) K_##key,
#define NAME(key, name)  name,
enum { KERNELS(PLACE) K_COUNT };
const char *const sv_wall_items_kernels[] = {KERNELS(NAME) NULL};
_Static_assert(K_SCANNED == SV_METHOD_SCANNED, "the frame finds it");
_Static_assert(K_COUNT <= SV_MAX_METHOD_KERNELS, "every kernel has a place");

sv_source sv_wall_items_source(void) {
    return (sv_source){sv_kernels_wall_items, sv_kernels_wall_items_size};
}

/* Layers to launch for the slab: those it reaches, but not the last one if a later slab ends it and another
 * one can take it, too (cl/wall/items_downsample.cl). One at least, for the warm-up. */
static uint32_t layers_to_launch(const sv_placed_slab *from, const sv_wall_layout *l) {
    const uint32_t end = from->first_slice + from->slice_count;
    const uint32_t layers = (end + l->depth - 1) / l->depth - from->first_slice / l->depth;
    const bool open = end % l->depth != 0 && end < l->slices;
    return layers > 1 && open ? layers - 1 : layers > 0 ? layers : 1;
}

static sv_status take_slab(const sv_map *m, sv_method_state *s, const sv_placed_slab *from) {
    const sv_wall_layout layout = sv_wall_own_of(s)->camera;
    const bool padded = sv_is_padded(m->config);
    sv_launch l = sv_slab_launch(m, s->kernels.kernel[K_RANGE], sv_wall_items_kernels[K_RANGE], from,
                                 s->buffer[SV_WALL_PLANES]);
    sv_launch_arg(&l, sizeof layout, &layout);
    sv_launch_buffer(&l, s->buffer[SV_WALL_RANGES]);
    sv_status status = SV_OK;
    if (padded || (m->config->ranged && from->first_slice == 0))
        status = sv_launch_pixels(&l, layout.width, layout.height, SV_STAGE_PROFILE);
    if (status != SV_OK) return status;
    l = sv_slab_launch(m, s->kernels.kernel[K_DOWNSAMPLE], sv_wall_items_kernels[K_DOWNSAMPLE], from,
                       s->buffer[SV_WALL_PLANES]);
    sv_launch_arg(&l, sizeof layout, &layout);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SPANS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_SUMS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_LEVELS]);
    return sv_launch_pixels(&l, layout.columns, layout.rows * layers_to_launch(from, &layout),
                            SV_STAGE_PROFILE);
}

static sv_status slabs(const sv_map *m, sv_method_state *s, const sv_placed_slabs *from) {
    return sv_slabs_one_by_one(m, s, from, take_slab);
}

static sv_status gather(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid) {
    const sv_wall_own *const own = sv_wall_own_of(s);
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_GATHER], sv_wall_items_kernels[K_GATHER]);
    sv_launch_arg(&l, sizeof own->beams, &own->beams);
    sv_launch_arg(&l, sizeof *grid, grid);
    sv_launch_buffer(&l, s->buffer[SV_WALL_TABLES]);
    sv_launch_buffer(&l, s->buffer[own->camera.smoothed ? SV_WALL_SMOOTHED : SV_WALL_LEVELS]);
    static const int outputs[] = {SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_HISTOGRAMS};
    for (size_t i = 0; i < sizeof outputs / sizeof *outputs; i++)
        sv_launch_buffer(&l, s->buffer[SV_WALL_BEAMS + outputs[i]]);
    return sv_launch_groups(&l, own->beams.cells[1], SV_STAGE_THRESHOLD);
}

static const sv_wall_launch launches[] = {
    {K_BLOCKS, SV_WALL_GROUPS,
     .buffers = {SV_WALL_SPANS, SV_WALL_RANGES, SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_HISTOGRAMS, -1},
     .takes = SV_WALL_BOUNDS},
    {K_SMOOTH, SV_WALL_GROUPS,
     .buffers = {SV_WALL_LEVELS, SV_WALL_RAYS, SV_WALL_SMOOTHED, SV_WALL_HISTOGRAMS, -1},
     .when = SV_WALL_IF_SMOOTHED},
    {K_DILATE_ROWS, SV_WALL_EACH_CELL, .buffers = {SV_WALL_LEVELS, SV_WALL_ROW_MAXIMA, -1}},
    {K_LEVELS, SV_WALL_ONE_GROUP, .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {K_DILATE_COLUMNS, SV_WALL_EACH_CELL, .buffers = {SV_WALL_INFO, SV_WALL_ROW_MAXIMA, SV_WALL_BRIGHT, -1}},
    {K_BRIGHT, SV_WALL_EACH_CELL, .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_WINDOWS, -1}},
    {K_BRIGHT_ROWS, SV_WALL_EACH_CELL, .buffers = {SV_WALL_INFO, SV_WALL_WINDOWS, SV_WALL_WINDOW_SUMS, -1}},
    {K_RELATIVE, SV_WALL_EACH_CELL,
     .buffers = {SV_WALL_INFO, SV_WALL_WINDOW_SUMS, SV_WALL_SMOOTHED, SV_WALL_RELATIVE, -1}},
    {K_NEAR_FIELD, SV_WALL_GROUPS,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_FRONTS, -1}},
    {K_FIRST_RUNS, SV_WALL_GROUPS,
     .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_RELATIVE, SV_WALL_BRIGHT, SV_WALL_RAYS,
                 SV_WALL_HISTOGRAMS, SV_WALL_FRONTS, -1}},
    {K_BETWEEN, SV_WALL_ROWS,
     .buffers = {SV_WALL_INFO, SV_WALL_LEVELS, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_LIMBS, -1},
     .when = SV_WALL_FOR_BEAMS},
    {K_FLOATING, SV_WALL_ALL_LAYERS, .buffers = {SV_WALL_LIMBS, -1}, .when = SV_WALL_FOR_BEAMS},
    {K_EVIDENCE, SV_WALL_ONE_GROUP, .buffers = {SV_WALL_HISTOGRAMS, SV_WALL_TABLES, SV_WALL_INFO, -1}},
    {K_SURROUNDINGS, SV_WALL_EACH_LAYER,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_BRIGHT, SV_WALL_RAYS, SV_WALL_FLAGS, -1}},
    {K_COSTS, SV_WALL_EACH_RAY,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_BRIGHT, SV_WALL_FLAGS, SV_WALL_RAYS, SV_WALL_SCRATCH,
                 -1}},
    {K_CELLS, SV_WALL_GROUPS, .buffers = {SV_WALL_INFO, SV_WALL_SCRATCH, SV_WALL_COSTS, SV_WALL_FETUS, -1}},
    {K_DECIDE, SV_WALL_ONCE, .buffers = {SV_WALL_FETUS, SV_WALL_TOLD, SV_WALL_INFO, -1}},
    {K_BLUR_Y, SV_WALL_EACH_CELL, .buffers = {SV_WALL_INFO, SV_WALL_COSTS, SV_WALL_SCRATCH, -1}},
    {K_BLUR_X, SV_WALL_EACH_CELL, .buffers = {SV_WALL_INFO, SV_WALL_SCRATCH, SV_WALL_FINE, -1}},
    {K_MINIMUM, SV_WALL_EACH_RAY, .buffers = {SV_WALL_INFO, SV_WALL_FINE, SV_WALL_PLANES, -1}},
    {K_MEDIAN, SV_WALL_EACH_RAY, .buffers = {SV_WALL_INFO, SV_WALL_PLANES, -1}},
    {K_GAPS, SV_WALL_GROUPS,
     .buffers = {SV_WALL_INFO, SV_WALL_SMOOTHED, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_PLANES, SV_WALL_GAPS,
                 -1},
     .when = SV_WALL_UNLESS_TOLD},
    {K_VERDICT, SV_WALL_ONCE, .buffers = {SV_WALL_GAPS, SV_WALL_TOLD, SV_WALL_INFO, -1},
     .takes = SV_WALL_RECORD},
    {K_CONFIDENCE, SV_WALL_EACH_RAY,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_PLANES, -1}},
    {K_ERODE, SV_WALL_EACH_RAY, .buffers = {SV_WALL_INFO, SV_WALL_RAYS, SV_WALL_PLANES, -1}},
    {K_OPEN, SV_WALL_EACH_RAY, .buffers = {SV_WALL_INFO, SV_WALL_PLANES, -1}},
    {K_KNOWN, SV_WALL_GROUPS, .buffers = {SV_WALL_INFO, SV_WALL_RAYS, SV_WALL_PLANES, SV_WALL_RIM, -1}},
    {K_RIM, SV_WALL_ONE_GROUP, .buffers = {SV_WALL_INFO, SV_WALL_RIM, -1}},
    {K_KNOB, SV_WALL_EACH_RAY,
     .buffers = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_RAYS, SV_WALL_FINE, SV_WALL_RIM, SV_WALL_PLANES,
                 -1}},
    {K_UPSAMPLE, SV_WALL_EACH_PIXEL, .buffers = {SV_WALL_INFO, SV_WALL_PLANES, SV_WALL_CONFIDENCE, -1},
     .takes = SV_WALL_DEPTH},
};
enum { COUNT = sizeof launches / sizeof *launches };

const sv_wall_work sv_wall_items = {.kernels = sv_wall_items_kernels,
                                    .slabs = slabs,
                                    .gather = gather,
                                    .mark = K_MARK_CELLS,
                                    .skip = K_SKIP_NEAR,
                                    .launches = launches,
                                    .count = COUNT,
                                    .reconstructs = 14,
                                    .first_at_q = COUNT - 2,
                                    .gathered = 2,
                                    .near = 9,
                                    .verdict = 22,
                                    .floated = 12,
                                    .surrounded = 14};
