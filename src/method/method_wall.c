/* SPDX-License-Identifier: MIT */
/*
 * Method wall: tissue in front of the fluid on most rays is the wall, and tissue brighter than the wall is
 * the fetus (docs/surface.md). It asks for no initial points; it takes the slabs themselves.
 */
#include "method/method_wall.h"

#include "device/queue.h"
#include "wall_layout.h"

#include <stdlib.h>

enum { RAY_PLANES = 5, SURFACE_PLANES = 8, HISTOGRAM_WORDS = 258 };

/* True if a work item has a ray: the strategy has been resolved by the device's type. */
static bool by_items(const sv_map *m) {
    return m->config->strategy == SV_STRATEGY_RAYS;
}

static const sv_wall_work *work_of(const sv_map *m) {
    return by_items(m) ? &sv_wall_items : &sv_wall_rows;
}

static void spacing_of(const sv_map *m, double mm[3]) {
    for (int axis = 0; axis < 3; axis++) mm[axis] = (double)m->config->spacing[axis];
}

/* Vectors of SV_WALL_TOGETHER rays in a row. */
static size_t vectors_of(const sv_wall_layout *l) {
    return (l->columns + SV_WALL_TOGETHER - 1u) / SV_WALL_TOGETHER;
}

static size_t padded_columns(const sv_wall_layout *l) {
    return sv_wall_lanes_of(l->columns);
}

/* Returns the words of 32 bits of scratch memory per row. By rows, in whole vectors: wall_costs needs 6
 * bytes a layer for each of SV_WALL_LANES rays, wall_blocks two lines of pixels' ranges and three lines of
 * levels, wall_bright and wall_blur two lines of cells. By items, wall_items_costs needs 5 bytes a block,
 * which is more than the 4 bytes a cell of wall_items_blur_y. */
static size_t scratch_words(const sv_map *m, const sv_wall_layout *l) {
    if (by_items(m)) return (size_t)5 * l->layers * padded_columns(l) / sizeof(cl_uint);
    const size_t layers = (size_t)6 * l->layers * SV_WALL_LANES / sizeof(cl_uint);
    const size_t cells = 2 * padded_columns(l) + (size_t)4 * SV_WALL_KERNEL;
    const size_t pixels = sv_wall_lanes_of(l->width) + (size_t)2 * SV_WALL_MAX_NEIGHBOUR;
    const size_t lines = cells > pixels ? cells : pixels;
    return layers > lines ? layers : lines;
}

/* Returns the bytes of the sums: by rows, 16 bits for each pixel of a row of rays, between margins, of two
 * layers; by items, 32 bits a ray. */
static size_t sum_bytes(const sv_map *m, const sv_wall_layout *l) {
    return by_items(m)
               ? padded_columns(l) * l->rows * sizeof(cl_uint)
               : (sv_wall_lanes_of(l->width) + (size_t)2 * SV_WALL_LANES) * 2 * l->rows * sizeof(cl_ushort);
}

/* The default settings in voxels, blocks and layers of a map, and in those of the beams. */
static sv_wall_own own_of(const sv_map *m) {
    const sv_wall_settings settings = sv_wall_settings_default();
    double mm[3];
    spacing_of(m, mm);
    sv_wall_own own = {.beams = sv_wall_grid_layout(&settings)};
    own.camera = sv_wall_layout_of(m->width, m->height, m->config->slices, mm, &settings);
    own.camera_words = (uint32_t)scratch_words(m, &own.camera);
    own.beam_words = (uint32_t)scratch_words(m, &own.beams);
    return own;
}

/* Finds the bytes of the buffers that every grid has: a camera's, or the one along the beams. */
static void find_bytes(const sv_map *m, const sv_wall_layout *l, size_t bytes[SV_WALL_BUFFERS]) {
    const size_t plane = padded_columns(l) * l->rows, margin = SV_WALL_BESIDE;
    const size_t cells = sv_wall_lanes_of(l->cells[0]) * l->cells[1] * l->layers;
    const size_t fine = margin + (sv_wall_lanes_of(l->cells[0]) + margin) * l->cells[1] * l->layers;
    const size_t level_row = padded_columns(l) + margin;
    for (int i = 0; i < SV_WALL_BUFFERS; i++) bytes[i] = 1;
    /* zeros lie behind the last layer of each row */
    bytes[SV_WALL_LEVELS] = bytes[SV_WALL_RELATIVE] = margin + level_row * l->rows * (l->layers + 1);
    bytes[SV_WALL_WINDOWS] = cells * sizeof(cl_uint);
    bytes[SV_WALL_FRONTS] = l->cells[1] * sizeof(cl_uint);
    bytes[SV_WALL_ROW_MAXIMA] = bytes[SV_WALL_BRIGHT] = cells;
    bytes[SV_WALL_FLAGS] = sv_wall_flags_bytes(l);
    bytes[SV_WALL_RAYS] = RAY_PLANES * plane * sizeof(cl_ushort);
    bytes[SV_WALL_HISTOGRAMS] = (size_t)l->cells[1] * HISTOGRAM_WORDS * sizeof(cl_uint);
    bytes[SV_WALL_INFO] = SV_WALL_INFO_WORDS * sizeof(cl_uint);
    bytes[SV_WALL_SCRATCH] = l->rows * scratch_words(m, l) * sizeof(cl_uint);
    bytes[SV_WALL_COSTS] = cells * sizeof(cl_ushort);
    const size_t rim = sv_wall_pyramid_cells(l->cells[0], l->cells[1]) * sizeof(cl_uint4);
    if (bytes[SV_WALL_RIM] < rim) bytes[SV_WALL_RIM] = rim;
    bytes[SV_WALL_FINE] = fine * sizeof(cl_ushort);
    bytes[SV_WALL_PLANES] = SURFACE_PLANES * plane * sizeof(cl_float);
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    sv_wall_own *const own = sv_wall_own_of(s);
    const size_t pixels = (size_t)m->padded_width * m->height;
    size_t bytes[SV_WALL_ALL_BUFFERS];
    *own = own_of(m);
    const sv_wall_layout *l = &own->camera;
    find_bytes(m, l, bytes);
    bytes[SV_WALL_SPANS] =
        (l->columns + l->rows) * sizeof(sv_wall_span) + vectors_of(l) * sizeof(sv_wall_taps);
    bytes[SV_WALL_SUMS] = sum_bytes(m, l);
    bytes[SV_WALL_RANGES] = sv_wall_is_bounded(m->config) ? 2 * pixels * sizeof(cl_ushort) : 1;
    bytes[SV_WALL_SMOOTHED] = l->smoothed ? bytes[SV_WALL_LEVELS] : 1;
    bytes[SV_WALL_TABLES] = SV_WALL_TABLE_WORDS * sizeof(cl_uint);
    bytes[SV_WALL_CONFIDENCE] = (size_t)m->width * m->height * sizeof(cl_float);
    find_bytes(m, &own->beams, bytes + SV_WALL_BEAMS);
    bytes[SV_WALL_BEAMS + SV_WALL_LIMBS] =
        (size_t)SV_WALL_LIMBS_PLANES * own->beams.layers * own->beams.rows * sizeof(cl_ulong);
    return sv_buffers_make(m->queue, bytes, SV_WALL_ALL_BUFFERS, s->buffer);
}

static sv_status write_buffer(const sv_map *m, cl_mem buffer, const void *data, size_t bytes) {
    const cl_int code =
        clEnqueueWriteBuffer(m->queue->device->queue, buffer, CL_TRUE, 0, bytes, data, 0, NULL, NULL);
    return sva_cl_check(m->queue->diag, code, "method wall: clEnqueueWriteBuffer");
}

static sv_status prepare(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = sv_wall_own_of(s)->camera;
    uint32_t tables[SV_WALL_TABLE_WORDS];
    const size_t count = (size_t)l.columns + l.rows;
    const size_t bytes = count * sizeof(sv_wall_span) + vectors_of(&l) * sizeof(sv_wall_taps);
    sv_wall_span *const spans = calloc(1, bytes);
    if (!spans)
        return sva_error(m->queue->diag, SV_ERR_NO_MEMORY, "method wall: no memory for %u spans", l.columns);
    for (uint32_t x = 0; x < l.columns; x++) spans[x] = sv_wall_span_of(x, l.width, l.columns);
    for (uint32_t y = 0; y < l.rows; y++) spans[l.columns + y] = sv_wall_span_of(y, l.height, l.rows);
    sv_wall_taps *const taps = (sv_wall_taps *)(spans + count);
    for (uint32_t i = 0; i < vectors_of(&l); i++)
        taps[i] = sv_wall_taps_of(spans, i * SV_WALL_TOGETHER, l.columns);
    const cl_uint nothing[SV_WALL_INFO_LAST + 1] = {[SV_WALL_INFO_LAST] = SV_WALL_EMPTY};
    sv_wall_tables(tables);
    sv_status status = write_buffer(m, s->buffer[SV_WALL_TABLES], tables, sizeof tables);
    if (status == SV_OK) status = write_buffer(m, s->buffer[SV_WALL_SPANS], spans, bytes);
    if (status == SV_OK) status = write_buffer(m, s->buffer[SV_WALL_INFO], nothing, sizeof nothing);
    if (status == SV_OK) status = write_buffer(m, s->buffer[SV_WALL_TOLD], nothing, sizeof nothing);
    free(spans);
    return status;
}

static sv_status slabs(const sv_map *m, sv_method_state *s, const sv_placed_slabs *from) {
    return work_of(m)->slabs(m, s, from);
}

/* Lays the grid along the beams into the camera's blocks, and launches their kernels before `end`. */
static sv_status along_beams(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid, uint32_t end) {
    const sv_wall_work *work = work_of(m);
    const sv_status status = work->gather(m, s, grid);
    return status == SV_OK ? sv_wall_launch_all(m, s, work, work->gathered, end, true, NULL) : status;
}

/* True if the camera is that of the frame before, too. A fan tells where it is; without one, beams that are
 * as they were say nothing of a camera that was only moved. */
static bool same_camera(const sv_wall_own *own, const sv_beams *b) {
    const sv_beams *const a = &own->seen;
    bool same = b->kind == SV_BEAMS_FAN && a->kind == b->kind && a->sweep_mm == b->sweep_mm;
    for (int i = 0; i < 9; i++) same = same && a->rotation[i] == b->rotation[i];
    for (int i = 0; i < 3; i++) same = same && a->apex_mm[i] == b->apex_mm[i];
    return same;
}

/* Asks the beams whether there is a surface, once a volume, and where limbs float, which the blocks of every
 * camera tell a little differently: so the map of a frame does not depend on the cameras before. */
static sv_status ask_beams(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid,
                           const sv_frame_context *frame) {
    sv_wall_own *const own = sv_wall_own_of(s);
    const bool holds = own->holds && frame->beams.same_volume, same = same_camera(own, &frame->beams);
    own->seen = frame->beams;
    own->holds = false; /* until all is launched */
    if (holds) return same ? SV_OK : along_beams(m, s, grid, work_of(m)->floated);
    own->beams.last = frame->continues && own->camera.told ? SV_WALL_REMEMBERED : SV_WALL_EMPTY;
    return along_beams(m, s, grid, work_of(m)->verdict + 1);
}

/* Marks the camera's cells at the samples of a plane of SV_WALL_LIMBS. */
static sv_status mark_cells(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid, uint32_t plane) {
    const sv_wall_work *work = work_of(m);
    const sv_wall_own *const own = sv_wall_own_of(s);
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[work->mark], work->kernels[work->mark]);
    sv_launch_arg(&l, sizeof own->camera, &own->camera);
    sv_launch_arg(&l, sizeof *grid, grid);
    sv_launch_uint(&l, plane);
    sv_launch_buffer(&l, s->buffer[SV_WALL_TABLES]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_BEAMS + SV_WALL_LIMBS]);
    sv_launch_buffer(&l, s->buffer[SV_WALL_FLAGS]);
    return sv_launch_pixels(&l, grid->lines, grid->planes, SV_STAGE_THRESHOLD);
}

/* Lets the camera's rays begin behind the near field that was skipped along the beams. */
static sv_status skip_near(const sv_map *m, sv_method_state *s, const sv_wall_grid *grid) {
    const sv_wall_work *work = work_of(m);
    const sv_wall_layout *const camera = &sv_wall_own_of(s)->camera;
    sv_status status = sv_buffer_clear(m->queue, s->buffer[SV_WALL_FLAGS], sv_wall_flags_bytes(camera));
    if (status == SV_OK) status = mark_cells(m, s, grid, SV_WALL_LIMBS_NEAR);
    if (status != SV_OK) return status;
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[work->skip], work->kernels[work->skip]);
    sv_launch_arg(&l, sizeof *camera, camera);
    static const int buffers_taken[] = {SV_WALL_INFO, SV_WALL_RELATIVE, SV_WALL_FLAGS, SV_WALL_RAYS};
    for (size_t i = 0; i < sizeof buffers_taken / sizeof *buffers_taken; i++)
        sv_launch_buffer(&l, s->buffer[buffers_taken[i]]);
    return sv_launch_pixels(&l, camera->columns, camera->rows, SV_STAGE_THRESHOLD);
}

static sv_status find(const sv_map *m, sv_method_state *s, const sv_frame_context *frame) {
    const sv_wall_work *work = work_of(m);
    const sv_wall_settings settings = sv_wall_settings_default();
    sv_wall_own *const own = sv_wall_own_of(s);
    sv_wall_grid grid;
    double mm[3];
    spacing_of(m, mm);
    own->camera.last = frame->continues ? SV_WALL_REMEMBERED : SV_WALL_EMPTY;
    own->camera.clip_doubtful = (uint32_t)m->values.of[SV_PARAM_UNSURE] == SV_UNSURE_CLIP;
    const bool told = sv_wall_grid_of(&own->camera, &own->beams, mm, &frame->beams, &settings, &grid);
    sv_status status = sv_wall_launch_all(m, s, work, 0, work->gathered, false, NULL);
    if (status == SV_OK && told) status = ask_beams(m, s, &grid, frame);
    if (status != SV_OK) return status;
    own->camera.told = told;
    own->holds = told;
    status = sv_wall_launch_all(m, s, work, work->gathered, work->near, false, NULL);
    if (status == SV_OK && told) status = skip_near(m, s, &grid);
    if (status == SV_OK) status = sv_wall_launch_all(m, s, work, work->near, work->surrounded, false, NULL);
    if (status == SV_OK && told) status = mark_cells(m, s, &grid, SV_WALL_LIMBS_FLOAT);
    if (status != SV_OK) return status;
    return sv_wall_launch_all(m, s, work, work->surrounded, work->first_at_q, false, NULL);
}

static sv_status place(const sv_map *m, sv_method_state *s, float q, const sv_depth_target *to) {
    sv_wall_own_of(s)->camera.q = q;
    return sv_wall_launch_all(m, s, work_of(m), work_of(m)->first_at_q, work_of(m)->count, false, to);
}

static cl_mem confidence(const sv_method_state *s) {
    return s->buffer[SV_WALL_CONFIDENCE];
}

/* Why there is no surface, or only a doubtful one. */
static void give_reason(const cl_uint *info, sv_confidence_report *out) {
    static const sv_reason reasons[] = {
        [SV_WALL_SURFACE] = SV_REASON_NONE,      [SV_WALL_NO_FLUID] = SV_REASON_NO_FLUID,
        [SV_WALL_EMPTY] = SV_REASON_EMPTY,       [SV_WALL_NO_FETUS] = SV_REASON_NO_FETUS,
        [SV_WALL_DOUBTFUL] = SV_REASON_DOUBTFUL, [SV_WALL_OPEN] = SV_REASON_OPEN};
    out->reason = reasons[info[SV_WALL_INFO_DOUBTFUL] ? SV_WALL_DOUBTFUL : info[SV_WALL_INFO_OUTCOME]];
    if (out->reason == SV_REASON_NONE || out->reason == SV_REASON_EMPTY) return;
    out->found = (float)info[SV_WALL_INFO_FOUND] / SV_WALL_PER_MILLE;
    out->wanted = (float)info[SV_WALL_INFO_WANTED] / SV_WALL_PER_MILLE;
    if (out->reason != SV_REASON_DOUBTFUL || info[SV_WALL_INFO_OUTCOME] == SV_WALL_SURFACE) return;
    out->try_id = SV_PARAM_UNSURE;
    out->try_value = SV_UNSURE_CLIP;
}

static sv_status confidence_report(const sv_map *m, const sv_method_state *s, sv_confidence_report *out) {
    cl_uint info[SV_WALL_INFO_WANTED + 1];
    const sv_status status = sv_buffer_read(m->queue, s->buffer[SV_WALL_INFO], sizeof info, info,
                                            "confidence: clEnqueueReadBuffer");
    if (status != SV_OK) return status;
    out->fluid_threshold = (float)info[SV_WALL_INFO_THRESHOLD] / 255.0f;
    out->rays = info[SV_WALL_INFO_RAYS];
    out->open_rays = info[SV_WALL_INFO_WALL_RAYS];
    give_reason(info, out);
    return SV_OK;
}

const sv_method sv_method_wall = {.parameters = SV_USES(UNSURE),
                                  .definition = &sv_ref_method_wall,
                                  .linear = false,
                                  .kernels = sv_wall_rows_kernels,
                                  .source = sv_wall_rows_source,
                                  .ray_kernels = sv_wall_items_kernels,
                                  .ray_source = sv_wall_items_source,
                                  .buffers = buffers,
                                  .prepare = prepare,
                                  .slabs = slabs,
                                  .find = find,
                                  .place = place,
                                  .confidence = confidence,
                                  .confidence_report = confidence_report};
