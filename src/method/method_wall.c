/* SPDX-License-Identifier: MIT */
/*
 * Method wall: whatever stands before the fluid on most rays is the wall, and the fetus is what is brighter
 * than the wall is (docs/surface.md). It asks for no initial points; it takes the slabs themselves.
 */
#include "method/method_wall.h"

#include "device/buffer.h"
#include "kernels_wall.h"
#include "ref/ref_wall.h"

enum {
    K_TAKE,
    K_MEANS,
    K_LEVELS,
    K_BRIGHTEST,
    K_WALLS,
    K_EVIDENCE,
    K_COSTS,
    K_DECIDE,
    K_BLUR,
    K_CHEAPEST,
    K_MEDIAN,
    K_TRUST,
    K_LEAVE
};
static const char *const kernels[] = {
    "wall_take",  "wall_means",  "wall_levels", "wall_brightest", "wall_walls",  "wall_evidence",
    "wall_costs", "wall_decide", "wall_blur",   "wall_cheapest",  "wall_median", "wall_trust",
    "wall_leave", NULL};
enum {
    VOXELS, /* later masks of tissue */
    BESIDE, /* brightest of the row */
    BRIGHT,
    RAYS,
    LINES,
    HISTOGRAMS, /* later FETUS */
    TABLES,
    INFO,
    SCRATCH,
    COSTS,
    AWAYS,
    BLURRED,
    CELLS,
    CONFIDENCE
};
enum { FETUS = HISTOGRAMS }; /* sums of rows of cells */
enum { RAY_PLANES = 6, CELL_PLANES = 3, HISTOGRAM_WORDS = 258 };
enum { INFO_THRESHOLD = 1, INFO_RAYS = 3, INFO_WALL_RAYS = 4, INFO_WORDS = 517 };

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

static uint32_t vectors_of(uint32_t values) {
    return (values + SV_LANES - 1) / SV_LANES;
}

static uint32_t padded_width(const sv_wall_layout *l) {
    return (l->width + SV_WALL_LANES - 1) / SV_WALL_LANES * SV_WALL_LANES;
}

/* Words of 16 bits that a row keeps while wall_means walks it: the ring, sums, a line of sums and one of
 * means between their margins; whole vectors. */
static uint32_t line_words(const sv_wall_layout *l) {
    const uint32_t margins = 10 * SV_WALL_LANES;
    return (2 * l->mean[2] + 1 + 5) * padded_width(l) + margins;
}

/* Vectors of 16 words of 32 bits that a row of cells keeps while wall_costs walks its rays: costs of
 * SV_WALL_LANES columns, sums of cells, what is kept of every slice, and rays of cells. */
static uint32_t scratch_vectors(const sv_wall_layout *l) {
    const uint32_t whole = 2; /* the next row begins with a whole vector of SV_WALL_LANES */
    const uint32_t wanted = 4 * l->labels + 2 * l->cells_x * vectors_of(l->labels) + (3 * l->slices + 1) / 2 +
                            vectors_of(l->cells_x);
    return (wanted + whole - 1) / whole * whole;
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    const sv_wall_layout l = layout_of(m);
    const size_t plane = (size_t)padded_width(&l) * m->height, cells = (size_t)l.cells_x * l.cells_y;
    const size_t costs = cells * vectors_of(l.labels) * sizeof(cl_uint16);
    const size_t bytes[] = {[VOXELS] = plane * l.slices,
                            [BESIDE] = plane * l.slices,
                            [BRIGHT] = plane * l.slices,
                            [RAYS] = RAY_PLANES * plane * sizeof(cl_ushort),
                            [LINES] = (size_t)m->height * line_words(&l) * sizeof(cl_ushort),
                            [HISTOGRAMS] = (size_t)m->height * HISTOGRAM_WORDS * sizeof(cl_uint),
                            [TABLES] = SV_WALL_TABLE_WORDS * sizeof(cl_uint),
                            [INFO] = INFO_WORDS * sizeof(cl_uint),
                            [SCRATCH] = (size_t)l.cells_y * scratch_vectors(&l) * sizeof(cl_uint16),
                            [COSTS] = costs,
                            [AWAYS] = costs,
                            [BLURRED] = costs,
                            [CELLS] = CELL_PLANES * cells * sizeof(cl_float),
                            [CONFIDENCE] = (size_t)m->width * m->height * sizeof(cl_float)};
    sv_status status = SV_OK;
    for (size_t i = 0; i < sizeof bytes / sizeof *bytes; i++)
        s->buffer[i] = sv_buffer_make(m->queue, bytes[i], &status);
    return status;
}

static sv_status prepare(const sv_map *m, sv_method_state *s) {
    uint32_t tables[SV_WALL_TABLE_WORDS];
    sv_wall_tables(tables);
    const cl_int code = clEnqueueWriteBuffer(m->queue->device->queue, s->buffer[TABLES], CL_TRUE, 0,
                                             sizeof tables, tables, 0, NULL, NULL);
    return sv_clx_check(m->queue->diag, code, "method wall: clEnqueueWriteBuffer");
}

static sv_status slab(const sv_map *m, sv_method_state *s, const sv_placed_slab *from) {
    const sv_config *c = m->config;
    const sv_wall_layout layout = layout_of(m);
    const cl_ulong first_byte = from->offset;
    const uint32_t padding = c->padding == SV_NO_PADDING ? 256 : (uint32_t)c->padding;
    const uint32_t numbers[] = {c->row_pitch,      c->tiles_x, c->tile_w, c->tile_h,      from->first_slice,
                                from->slice_count, padding,    c->ranged, m->padded_width};
    sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[K_TAKE], kernels[K_TAKE]);
    sv_launch_buffer(&l, from->buffer);
    sv_launch_arg(&l, sizeof first_byte, &first_byte);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(&l, numbers[i]);
    sv_launch_buffer(&l, c->ranged ? m->scanned : s->buffer[CELLS]); /* without ranges it is not read */
    sv_launch_arg(&l, sizeof layout, &layout);
    sv_launch_buffer(&l, s->buffer[VOXELS]);
    sv_launch_buffer(&l, s->buffer[RAYS]);
    return sv_launch_items(&l, m->height, SV_STAGE_PROFILE);
}

typedef enum { ONCE, SLICES, ROWS_OF_CELLS, ROWS } items;

/* Arguments besides the method's buffers: numbers before them, the frame's buffers behind. */
enum { LINE_WORDS = 1, SCRATCH_VECTORS = 2, RECORD = 4, SURFACES = 8 };

/* What follows the slabs, in this order. */
static const struct {
    int kernel, takes;
    items items;
    sv_stage stage;
    int buffers[9]; /* up to -1 */
} launches[] = {
    {K_MEANS, LINE_WORDS, ROWS, SV_STAGE_THRESHOLD, {VOXELS, RAYS, LINES, BESIDE, HISTOGRAMS, -1}},
    {K_LEVELS, 0, ONCE, SV_STAGE_THRESHOLD, {HISTOGRAMS, TABLES, INFO, -1}},
    {K_BRIGHTEST, 0, SLICES, SV_STAGE_THRESHOLD, {INFO, BESIDE, BRIGHT, -1}},
    {K_WALLS, 0, ROWS, SV_STAGE_THRESHOLD, {INFO, BRIGHT, VOXELS, RAYS, HISTOGRAMS, -1}},
    {K_EVIDENCE, 0, ONCE, SV_STAGE_THRESHOLD, {HISTOGRAMS, TABLES, INFO, -1}},
    {K_COSTS,
     SCRATCH_VECTORS,
     ROWS_OF_CELLS,
     SV_STAGE_RECONSTRUCT,
     {INFO, VOXELS, BRIGHT, RAYS, SCRATCH, COSTS, AWAYS, FETUS, -1}},
    {K_DECIDE, RECORD, ONCE, SV_STAGE_RECONSTRUCT, {FETUS, INFO, -1}},
    {K_BLUR, 0, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, COSTS, BLURRED, -1}},
    {K_CHEAPEST, 0, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, BLURRED, SCRATCH, CELLS, -1}},
    {K_MEDIAN, 0, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, COSTS, AWAYS, CELLS, -1}},
    {K_TRUST, 0, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, CELLS, -1}},
    {K_LEAVE, SURFACES, ROWS, SV_STAGE_RECONSTRUCT, {INFO, CELLS, CONFIDENCE, -1}},
};

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    (void)planes; /* both, always: the surface is the same for every q */
    const sv_wall_layout layout = layout_of(m);
    const size_t count[] = {
        [ONCE] = 1, [SLICES] = layout.slices, [ROWS_OF_CELLS] = layout.cells_y, [ROWS] = layout.height};
    sv_status status = SV_OK;
    for (size_t i = 0; status == SV_OK && i < sizeof launches / sizeof *launches; i++) {
        const int kernel = launches[i].kernel, takes = launches[i].takes;
        sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[kernel], kernels[kernel]);
        sv_launch_arg(&l, sizeof layout, &layout);
        if (takes & LINE_WORDS) sv_launch_uint(&l, line_words(&layout));
        if (takes & SCRATCH_VECTORS) sv_launch_uint(&l, scratch_vectors(&layout));
        for (const int *b = launches[i].buffers; *b >= 0; b++) sv_launch_buffer(&l, s->buffer[*b]);
        if (takes & RECORD) sv_launch_buffer(&l, m->record);
        if (takes & SURFACES) sv_launch_uint(&l, m->padded_width);
        if (takes & SURFACES) sv_launch_buffer(&l, m->surfaces);
        status = sv_launch_items(&l, count[launches[i].items], launches[i].stage);
    }
    return status;
}

static cl_mem confidence(const sv_method_state *s) {
    return s->buffer[CONFIDENCE];
}

static sv_status confidence_report(const sv_map *m, const sv_method_state *s, sv_confidence_report *out) {
    cl_uint info[INFO_WALL_RAYS + 1];
    const cl_int code = clEnqueueReadBuffer(m->queue->device->queue, s->buffer[INFO], CL_TRUE, 0, sizeof info,
                                            info, 0, NULL, NULL);
    if (code != CL_SUCCESS) return sv_clx_check(m->queue->diag, code, "confidence: clEnqueueReadBuffer");
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
                                  .linear = true,
                                  .kernels = kernels,
                                  .source = source,
                                  .commands = commands,
                                  .buffers = buffers,
                                  .prepare = prepare,
                                  .slab = slab,
                                  .run = run,
                                  .confidence = confidence,
                                  .confidence_report = confidence_report};
