/* SPDX-License-Identifier: MIT */
/*
 * Method wall: tissue in front of the fluid on most rays is the wall, and tissue brighter than the wall is
 * the fetus (docs/surface.md). It asks for no initial points; it takes the slabs themselves.
 */
#include "method/method_wall.h"

#include "device/queue.h"
#include "ref/ref_wall.h"
#include "wall_layout.h"

#include <stdlib.h>

enum { RAY_PLANES = 4, PLACE_PLANES = 8, HISTOGRAM_WORDS = 258 };

/* True if a work item has a ray: the strategy has been resolved by the device's type. */
static bool by_items(const sv_map *m) {
    return m->config->strategy == SV_STRATEGY_RAYS;
}

static const sv_wall_work *work_of(const sv_map *m) {
    return by_items(m) ? &sv_wall_items : &sv_wall_rows;
}

_Static_assert((int)SV_WALL_EXTENT_MM == (int)SV_ASSUMED_EXTENT_MM, "an unknown spacing is assumed alike");

/* The default settings in voxels, blocks and layers of a map. */
static sv_wall_layout layout_of(const sv_map *m) {
    const float *mm = m->config->spacing;
    const double spacing_mm[3] = {(double)mm[0], (double)mm[1], (double)mm[2]};
    const sv_wall_settings settings = sv_wall_settings_default();
    return sv_wall_layout_of(m->width, m->height, m->config->slices, spacing_mm, &settings);
}

/* Vectors of SV_WALL_TOGETHER rays in a row. */
static size_t vectors_of(const sv_wall_layout *l) {
    return (l->columns + SV_WALL_TOGETHER - 1u) / SV_WALL_TOGETHER;
}

static size_t padded_columns(const sv_wall_layout *l) {
    return sv_wall_lanes_of(l->columns);
}

/* Returns the words of 32 bits of scratch memory per row. By rows, in whole vectors: wall_costs needs 8
 * bytes a layer for each of SV_WALL_LANES rays, wall_blocks two lines of pixels' ranges and three lines of
 * levels, wall_bright and wall_blur two lines of cells. By items, wall_items_costs needs 5 bytes a block,
 * which is more than the 4 bytes a cell of wall_items_blur_y. */
static size_t scratch_words(const sv_map *m, const sv_wall_layout *l) {
    if (by_items(m)) return (size_t)5 * l->layers * padded_columns(l) / sizeof(cl_uint);
    const size_t layers = (size_t)2 * l->layers * SV_WALL_LANES;
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

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = layout_of(m);
    *sv_wall_layout_in(s) = l;
    const size_t pixels = (size_t)m->padded_width * m->height, plane = padded_columns(&l) * l.rows;
    const size_t cells = sv_wall_lanes_of(l.cells[0]) * l.cells[1] * l.layers;
    const size_t fine = SV_WALL_MAX_NEIGHBOUR +
                        (sv_wall_lanes_of(l.cells[0]) + SV_WALL_MAX_NEIGHBOUR) * l.cells[1] * l.layers;
    const size_t margin = SV_WALL_MAX_NEIGHBOUR, level_row = padded_columns(&l) + margin;
    const size_t levels =
        margin + level_row * l.rows * (l.layers + 1); /* zeros lie behind the last layer of each row */
    const size_t bytes[SV_WALL_BUFFERS] = {
        [SV_WALL_SPANS] = (l.columns + l.rows) * sizeof(sv_wall_span) + vectors_of(&l) * sizeof(sv_wall_taps),
        [SV_WALL_SUMS] = sum_bytes(m, &l),
        [SV_WALL_RANGES] = sv_wall_is_bounded(m->config) ? 2 * pixels * sizeof(cl_ushort) : 1,
        [SV_WALL_LEVELS] = levels,
        [SV_WALL_SMOOTHED] = l.smoothed ? levels : 1,
        [SV_WALL_RELATIVE] = levels,
        [SV_WALL_WINDOWS] = cells * sizeof(cl_uint),
        [SV_WALL_FRONTS] = l.cells[1] * sizeof(cl_uint),
        [SV_WALL_ROW_MAXIMA] = cells,
        [SV_WALL_BRIGHT] = cells,
        [SV_WALL_KINDS] = sv_wall_kinds_bytes(&l),
        [SV_WALL_RAYS] = RAY_PLANES * plane * sizeof(cl_ushort),
        [SV_WALL_HISTOGRAMS] = (size_t)l.cells[1] * HISTOGRAM_WORDS * sizeof(cl_uint),
        [SV_WALL_TABLES] = SV_WALL_TABLE_WORDS * sizeof(cl_uint),
        [SV_WALL_INFO] = SV_WALL_INFO_WORDS * sizeof(cl_uint),
        [SV_WALL_SCRATCH] = l.rows * scratch_words(m, &l) * sizeof(cl_uint),
        [SV_WALL_COSTS] = cells * sizeof(cl_ushort),
        [SV_WALL_FINE] = fine * sizeof(cl_ushort),
        [SV_WALL_PLACES] = PLACE_PLANES * plane * sizeof(cl_float),
        [SV_WALL_CONFIDENCE] = (size_t)m->width * m->height * sizeof(cl_float)};
    return sv_buffers_make(m->queue, bytes, SV_WALL_BUFFERS, s->buffer);
}

static sv_status write_buffer(const sv_map *m, cl_mem buffer, const void *data, size_t bytes) {
    const cl_int code =
        clEnqueueWriteBuffer(m->queue->device->queue, buffer, CL_TRUE, 0, bytes, data, 0, NULL, NULL);
    return sva_cl_check(m->queue->diag, code, "method wall: clEnqueueWriteBuffer");
}

static sv_status prepare(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = *sv_wall_layout_in(s);
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
    free(spans);
    return status;
}

static sv_status slabs(const sv_map *m, sv_method_state *s, const sv_placed_slabs *from) {
    return work_of(m)->slabs(m, s, from);
}

static sv_status find(const sv_map *m, sv_method_state *s, const sv_frame_context *frame) {
    sv_wall_layout *l = sv_wall_layout_in(s);
    l->last = frame->continues ? SV_WALL_REMEMBERED : SV_WALL_EMPTY;
    l->clip_doubtful = (uint32_t)m->values.of[SV_PARAM_UNSURE] == SV_UNSURE_CLIP;
    return sv_wall_launch_all(m, s, work_of(m), 0, work_of(m)->first_at_q, (uint32_t)scratch_words(m, l),
                              NULL);
}

static sv_status place(const sv_map *m, sv_method_state *s, float q, const sv_depth_target *to) {
    sv_wall_layout *l = sv_wall_layout_in(s);
    l->q = q;
    return sv_wall_launch_all(m, s, work_of(m), work_of(m)->first_at_q, work_of(m)->count,
                              (uint32_t)scratch_words(m, l), to);
}

static cl_mem confidence(const sv_method_state *s) {
    return s->buffer[SV_WALL_CONFIDENCE];
}

/* Why there is no surface, or only a doubtful one. */
static void give_reason(const cl_uint *info, sv_confidence_report *out) {
    static const sv_reason reasons[] = {[SV_WALL_SURFACE] = SV_REASON_NONE,
                                        [SV_WALL_NO_FLUID] = SV_REASON_NO_FLUID,
                                        [SV_WALL_EMPTY] = SV_REASON_EMPTY,
                                        [SV_WALL_NO_FETUS] = SV_REASON_NO_FETUS,
                                        [SV_WALL_DOUBTFUL] = SV_REASON_DOUBTFUL};
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
