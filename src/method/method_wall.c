/* SPDX-License-Identifier: MIT */
/*
 * Method wall: whatever stands before the fluid on most rays is the wall, and the fetus is what is brighter
 * than the wall is (docs/surface.md). It asks for no initial points; it takes the slabs themselves.
 */
#include "method/method_wall.h"

#include "device/buffer.h"
#include "kernels_wall.h"
#include "method/method_slabs.h"
#include "ref/ref_wall.h"

#include <stdlib.h>

enum {
    K_TAKE,
    K_BLOCKS,
    K_STEADY,
    K_LEVELS,
    K_WALLS,
    K_EVIDENCE,
    K_COSTS,
    K_DECIDE,
    K_CHEAPEST,
    K_MEDIAN,
    K_TRUST,
    K_TURN,
    K_LEAVE
};
static const char *const kernels[] = {
    "wall_take",   "wall_blocks",   "wall_steady", "wall_levels", "wall_walls", "wall_evidence", "wall_costs",
    "wall_decide", "wall_cheapest", "wall_median", "wall_trust",  "wall_turn",  "wall_leave",    NULL};
enum {
    SPANS,
    SUMS,   /* of the layer that the slabs are in */
    RANGES, /* of pixels */
    LEVELS,
    STEADY, /* the same, smoothed where blocks are one voxel; else LEVELS take its place */
    BESIDE, /* brightest of the row */
    BRIGHT,
    RAYS,
    HISTOGRAMS, /* later FETUS */
    TABLES,
    INFO,
    SCRATCH,
    COSTS,
    AWAYS,
    PLACES,
    CONFIDENCE
};
enum { FETUS = HISTOGRAMS }; /* sums of rows of rays */
enum { RAY_PLANES = 4, PLACE_PLANES = 8, HISTOGRAM_WORDS = 258 };
enum { INFO_THRESHOLD = 1, INFO_RAYS = 3, INFO_WALL_RAYS = 4, INFO_WORDS = 520 };

static sv_source source(void) {
    return (sv_source){sv_kernels_wall, sv_kernels_wall_size};
}

static uint32_t commands(const sv_config *c) {
    return c->slices + K_LEAVE;
}

static sv_wall_layout layout_of(const sv_map *m) {
    const float *mm = m->config->spacing;
    const double spacing_mm[3] = {(double)mm[0], (double)mm[1], (double)mm[2]};
    const sv_wall_settings settings = sv_wall_settings_default();
    return sv_wall_layout_of(m->width, m->height, m->config->slices, spacing_mm, &settings);
}

static bool is_bounded(const sv_config *c) {
    return c->ranged || c->padding != SV_NO_PADDING;
}

static bool is_steadied(const sv_wall_layout *l) {
    return l->single[0] || l->single[1] || l->single[2];
}

static size_t lanes_of(uint32_t values) {
    return ((size_t)values + SV_WALL_LANES - 1) / SV_WALL_LANES * SV_WALL_LANES;
}

static size_t padded_columns(const sv_wall_layout *l) {
    return lanes_of(l->columns);
}

/* Words of 32 bits that a row of rays keeps: wall_cheapest's two lines between margins and the costs of every
 * layer. wall_costs needs less: 3 bytes a layer for each of SV_WALL_LANES rays. Whole vectors. */
static size_t scratch_words(const sv_wall_layout *l) {
    return (l->layers + 2) * padded_columns(l) + (size_t)4 * SV_WALL_KERNEL;
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = layout_of(m);
    const size_t pixels = (size_t)m->padded_width * m->height, plane = padded_columns(&l) * l.rows;
    const size_t margin = SV_WALL_BESIDE, level_row = padded_columns(&l) + margin;
    const size_t levels = margin + level_row * l.rows * (l.layers + 1); /* zeros behind the last layer */
    const size_t bytes[] = {[SPANS] = (l.columns + l.rows) * sizeof(sv_wall_span),
                            [SUMS] = lanes_of(l.width) * l.rows * sizeof(cl_ushort),
                            [RANGES] = is_bounded(m->config) ? 2 * pixels * sizeof(cl_ushort) : 1,
                            [LEVELS] = levels,
                            [STEADY] = is_steadied(&l) ? levels : 1,
                            [BESIDE] = plane * l.layers,
                            [BRIGHT] = plane * l.layers,
                            [RAYS] = RAY_PLANES * plane * sizeof(cl_ushort),
                            [HISTOGRAMS] = (size_t)l.rows * HISTOGRAM_WORDS * sizeof(cl_uint),
                            [TABLES] = SV_WALL_TABLE_WORDS * sizeof(cl_uint),
                            [INFO] = INFO_WORDS * sizeof(cl_uint),
                            [SCRATCH] = l.rows * scratch_words(&l) * sizeof(cl_uint),
                            [COSTS] = plane * l.layers * sizeof(cl_ushort),
                            [AWAYS] = plane * l.layers,
                            [PLACES] = PLACE_PLANES * plane * sizeof(cl_float),
                            [CONFIDENCE] = (size_t)m->width * m->height * sizeof(cl_float)};
    return sv_buffers_make(m->queue, bytes, sizeof bytes / sizeof *bytes, s->buffer);
}

static sv_status write_buffer(const sv_map *m, cl_mem buffer, const void *data, size_t bytes) {
    const cl_int code =
        clEnqueueWriteBuffer(m->queue->device->queue, buffer, CL_TRUE, 0, bytes, data, 0, NULL, NULL);
    return sv_clx_check(m->queue->diag, code, "method wall: clEnqueueWriteBuffer");
}

static sv_status prepare(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = layout_of(m);
    uint32_t tables[SV_WALL_TABLE_WORDS];
    sv_wall_span *const spans = calloc((size_t)l.columns + l.rows, sizeof *spans);
    if (!spans)
        return sv_fail(m->queue->diag, SV_ERR_NO_MEMORY, "method wall: no memory for %u spans", l.columns);
    for (uint32_t x = 0; x < l.columns; x++) spans[x] = sv_wall_span_of(x, l.width, l.columns);
    for (uint32_t y = 0; y < l.rows; y++) spans[l.columns + y] = sv_wall_span_of(y, l.height, l.rows);
    sv_wall_tables(tables);
    sv_status status = write_buffer(m, s->buffer[TABLES], tables, sizeof tables);
    if (status == SV_OK)
        status = write_buffer(m, s->buffer[SPANS], spans, ((size_t)l.columns + l.rows) * sizeof *spans);
    free(spans);
    return status;
}

static sv_status slab(const sv_map *m, sv_method_state *s, const sv_placed_slab *from) {
    const sv_wall_layout layout = layout_of(m);
    sv_launch l = sv_slab_launch(m, s->kernels.kernel[K_TAKE], kernels[K_TAKE], from, s->buffer[PLACES]);
    sv_launch_arg(&l, sizeof layout, &layout);
    sv_launch_buffer(&l, s->buffer[SPANS]);
    sv_launch_buffer(&l, s->buffer[SUMS]);
    sv_launch_buffer(&l, s->buffer[RANGES]);
    sv_launch_buffer(&l, s->buffer[LEVELS]);
    return sv_launch_items(&l, layout.rows, SV_STAGE_PROFILE);
}

typedef enum { ONCE, RAY_ROWS, PIXEL_ROWS } items;

/* Arguments besides the method's buffers: numbers before them, the frame's buffers behind. */
enum { BOUNDS = 1, SCRATCH_WORDS = 2, RECORD = 4, SURFACES = 8 };

/* What follows the slabs, in this order. */
static const struct {
    int kernel, takes;
    items items;
    sv_stage stage;
    int buffers[9]; /* up to -1 */
} launches[] = {
    {K_BLOCKS, BOUNDS, RAY_ROWS, SV_STAGE_THRESHOLD, {SPANS, RANGES, LEVELS, RAYS, BESIDE, HISTOGRAMS, -1}},
    {K_STEADY, 0, RAY_ROWS, SV_STAGE_THRESHOLD, {LEVELS, RAYS, STEADY, HISTOGRAMS, -1}},
    {K_LEVELS, 0, ONCE, SV_STAGE_THRESHOLD, {HISTOGRAMS, TABLES, INFO, -1}},
    {K_WALLS, 0, RAY_ROWS, SV_STAGE_THRESHOLD, {INFO, STEADY, BESIDE, BRIGHT, RAYS, HISTOGRAMS, -1}},
    {K_EVIDENCE, 0, ONCE, SV_STAGE_THRESHOLD, {HISTOGRAMS, TABLES, INFO, -1}},
    {K_COSTS,
     SCRATCH_WORDS,
     RAY_ROWS,
     SV_STAGE_RECONSTRUCT,
     {INFO, STEADY, BRIGHT, RAYS, SCRATCH, COSTS, AWAYS, FETUS, -1}},
    {K_DECIDE, RECORD, ONCE, SV_STAGE_RECONSTRUCT, {FETUS, INFO, -1}},
    {K_CHEAPEST, SCRATCH_WORDS, RAY_ROWS, SV_STAGE_RECONSTRUCT, {INFO, COSTS, SCRATCH, PLACES, -1}},
    {K_MEDIAN, 0, RAY_ROWS, SV_STAGE_RECONSTRUCT, {INFO, COSTS, AWAYS, PLACES, -1}},
    {K_TRUST, 0, RAY_ROWS, SV_STAGE_RECONSTRUCT, {INFO, PLACES, -1}},
    {K_TURN, 0, RAY_ROWS, SV_STAGE_RECONSTRUCT, {INFO, PLACES, -1}},
    {K_LEAVE, SURFACES, PIXEL_ROWS, SV_STAGE_RECONSTRUCT, {INFO, PLACES, CONFIDENCE, -1}},
};
enum { ALL = sizeof launches / sizeof *launches, FIRST_OF_TURN = ALL - 2 };

static sv_status run_from(const sv_map *m, sv_method_state *s, size_t first, size_t end, float q) {
    sv_wall_layout layout = layout_of(m);
    const bool steadied = is_steadied(&layout);
    layout.q = q;
    const size_t count[] = {[ONCE] = 1, [RAY_ROWS] = layout.rows, [PIXEL_ROWS] = layout.height};
    sv_status status = SV_OK;
    for (size_t i = first; status == SV_OK && i < end; i++) {
        const int kernel = launches[i].kernel, takes = launches[i].takes;
        if (kernel == K_STEADY && !steadied) continue;
        sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[kernel], kernels[kernel]);
        sv_launch_arg(&l, sizeof layout, &layout);
        if (takes & BOUNDS) sv_launch_uint(&l, is_bounded(m->config));
        if (takes & BOUNDS) sv_launch_uint(&l, m->padded_width);
        if (takes & SCRATCH_WORDS) sv_launch_uint(&l, (uint32_t)scratch_words(&layout));
        for (const int *b = launches[i].buffers; *b >= 0; b++)
            sv_launch_buffer(&l, s->buffer[*b == STEADY && !steadied ? LEVELS : *b]);
        if (takes & RECORD) sv_launch_buffer(&l, m->record);
        if (takes & SURFACES) sv_launch_uint(&l, m->padded_width);
        if (takes & SURFACES) sv_launch_buffer(&l, m->surfaces);
        status = sv_launch_items(&l, count[launches[i].items], launches[i].stage);
    }
    return status;
}

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    (void)planes; /* one: `turn` makes it */
    return run_from(m, s, 0, FIRST_OF_TURN, 0.5f);
}

static sv_status turn(const sv_map *m, sv_method_state *s, float q) {
    return run_from(m, s, FIRST_OF_TURN, ALL, q);
}

static cl_mem confidence(const sv_method_state *s) {
    return s->buffer[CONFIDENCE];
}

static sv_status confidence_report(const sv_map *m, const sv_method_state *s, sv_confidence_report *out) {
    cl_uint info[INFO_WALL_RAYS + 1];
    const sv_status status =
        sv_buffer_read(m->queue, s->buffer[INFO], sizeof info, info, "confidence: clEnqueueReadBuffer");
    if (status != SV_OK) return status;
    out->fluid_threshold = (float)info[INFO_THRESHOLD] / 255.0f;
    out->rays = info[INFO_RAYS];
    out->open_rays = info[INFO_WALL_RAYS];
    return SV_OK;
}

/* Integers up to the cheapest labels, which are the definition's; then some ten float32 operations on numbers
 * up to the depth. Where division is rounded correctly nothing differs; elsewhere by a few units in the last
 * place. */
static double bound(const sv_map *m) {
    return m->config->slices * 16.0 * 0x1p-24;
}

const sv_method sv_method_wall = {.definition = &sv_ref_method_wall,
                                  .bound = bound,
                                  .linear = false,
                                  .kernels = kernels,
                                  .source = source,
                                  .commands = commands,
                                  .buffers = buffers,
                                  .prepare = prepare,
                                  .slab = slab,
                                  .run = run,
                                  .turn = turn,
                                  .confidence = confidence,
                                  .confidence_report = confidence_report};
