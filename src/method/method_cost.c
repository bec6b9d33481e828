/* SPDX-License-Identifier: MIT */
/*
 * Method cost: every ray pays for every depth, the rays of a neighbourhood together, and the cheapest depth
 * is the surface (docs/cost_volume.md). It asks for no initial points; it takes the slabs themselves, as bins
 * along the rays.
 */
#include "method/method.h"

#include "cost_layout.h"
#include "device/queue.h"
#include "kernels_cost.h"

#include <math.h>

enum {
    K_BINS,
    K_HISTOGRAM,
    K_LEVEL,
    K_WALLS_OWN,
    K_WALLS,
    K_GATHER,
    K_DECIDE,
    K_BLUR,
    K_MINIMUM,
    K_MEDIAN,
    K_UPSAMPLE
};
static const char *const kernels[] = {"cost_bins",    "cost_histogram", "cost_level",    "cost_walls_own",
                                      "cost_walls",   "cost_gather",    "cost_decide",   "cost_blur",
                                      "cost_minimum", "cost_median",    "cost_upsample", NULL};
enum {
    BINS,
    PARTIAL,
    SUMS,       /* for every band a ring of rows of rays: sums of every bin with its neighbours, */
    BRIGHTEST,  /* and their maxima nearby in the same row of rays */
    TILES,      /* a tile for every band */
    OWN,        /* wall and back of every cell by itself */
    WALLS,      /* wall and back of every cell by its neighbourhood */
    HISTOGRAMS, /* 256 words a row of cells */
    COUNTS,
    INFO,
    VOLUME, /* later the smooth minima */
    BLURRED,
    PREVIOUS, /* costs of the frame before */
    MINIMA,
    CONFIDENCE
};

/* Size of bin16_t of cl/cost/cost_tile.clh: 16 rays at a label. */
enum { TILE_BYTES = 3 * SV_LANES * (int)sizeof(cl_short) };

static sv_source source(void) {
    return (sv_source){sv_kernels_cost, sv_kernels_cost_size};
}

static sv_cost_layout layout_of(const sv_map *m) {
    return sv_cost_layout_of(m->width, m->height, m->config->slices, m->config->spacing[2]);
}

/* A work item takes rows of cells one after the other. The more it takes, the fewer rows of rays are
 * computed twice, but some work items have little to do. */
enum { BANDS_PER_UNIT = 2 };
static uint32_t band_rows(const sv_map *m, const sv_cost_layout *l) {
    const uint32_t wanted = m->queue->device->compute_units * BANDS_PER_UNIT;
    return (l->cells_y + wanted - 1) / wanted;
}

static uint32_t band_count(const sv_map *m, const sv_cost_layout *l) {
    const uint32_t rows = band_rows(m, l);
    return (l->cells_y + rows - 1) / rows;
}

static sv_status buffers(const sv_map *m, sv_method_state *s) {
    const sv_cost_layout l = layout_of(m);
    const size_t plane = (size_t)m->padded_width * m->height, cells = (size_t)l.cells_x * l.cells_y;
    const size_t row = (size_t)l.labels * l.padded_columns, bins = row * l.rows;
    const size_t ring = row * sv_cost_ring_rows(&l), bands = band_count(m, &l);
    const size_t bytes[] = {[BINS] = bins,
                            [PARTIAL] = 2 * plane * sizeof(cl_ushort),
                            [SUMS] = bands * ring * sizeof(cl_ushort),
                            [BRIGHTEST] = bands * ring * sizeof(cl_ushort),
                            [TILES] = bands * l.block * l.labels * TILE_BYTES,
                            [OWN] = 2 * cells,
                            [WALLS] = 2 * cells,
                            [HISTOGRAMS] = 256 * (size_t)l.cells_y * sizeof(cl_uint),
                            [COUNTS] = 2 * (size_t)l.cells_y * sizeof(cl_uint),
                            [INFO] = SV_COST_INFO_WORDS * sizeof(cl_uint),
                            [VOLUME] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [BLURRED] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [PREVIOUS] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [MINIMA] = cells * 4 * sizeof(cl_float),
                            [CONFIDENCE] = (size_t)m->width * m->height * sizeof(cl_float)};
    return sv_buffers_make(m->queue, bytes, sizeof bytes / sizeof *bytes, s->buffer);
}

static void layout_arg(sv_launch *launch, const sv_map *m) {
    const sv_cost_layout layout = layout_of(m);
    sv_launch_arg(launch, sizeof layout, &layout);
}

/* Passes the lateral Gaussian at 0 .. SV_COST_REACH cells. */
static void weights_arg(sv_launch *launch, const sv_map *m) {
    const sv_cost_layout layout = layout_of(m);
    const double sigma = sv_cost_sigma(&layout);
    cl_float8 weight = {{0}};
    for (int i = 0; i <= SV_COST_REACH; i++) weight.s[i] = (float)exp(-0.5 * i * i / (sigma * sigma));
    sv_launch_arg(launch, sizeof weight, &weight);
}

/* Passes buffers of the state, up to a negative index. */
static void buffer_args(sv_launch *launch, const sv_method_state *s, const int *indices) {
    for (; *indices >= 0; indices++) sv_launch_buffer(launch, s->buffer[*indices]);
}

static sv_status take_slab(const sv_map *m, sv_method_state *s, const sv_placed_slab *from) {
    sv_launch l = sv_slab_launch(m, s->kernels.kernel[K_BINS], kernels[K_BINS], from, s->buffer[PARTIAL]);
    layout_arg(&l, m);
    buffer_args(&l, s, (const int[]){PARTIAL, BINS, -1});
    return sv_launch_items(&l, layout_of(m).rows, SV_STAGE_PROFILE);
}

static sv_status slabs(const sv_map *m, sv_method_state *s, const sv_placed_slabs *from) {
    return sv_slabs_one_by_one(m, s, from, take_slab);
}

typedef enum { ONCE, BANDS, ROWS_OF_CELLS, ROWS_OF_PIXELS } items;

/* Arguments besides the method's buffers: the record and the surfaces behind them, the others before. */
enum { WEIGHTS = 1, REMEMBERED = 2, MAP_WIDTH = 4, RECORD = 8, SURFACES = 16, BAND = 32 };

/* The launches that follow the bins, in this order. */
static const struct {
    int kernel, takes;
    items items;
    sv_stage stage;
    int buffers[9]; /* up to -1 */
} launches[] = {
    {K_HISTOGRAM, 0, ROWS_OF_CELLS, SV_STAGE_THRESHOLD, {BINS, HISTOGRAMS, -1}},
    {K_LEVEL, 0, ONCE, SV_STAGE_THRESHOLD, {HISTOGRAMS, INFO, -1}},
    {K_WALLS_OWN, 0, ROWS_OF_CELLS, SV_STAGE_THRESHOLD, {BINS, INFO, OWN, -1}},
    {K_WALLS, 0, ROWS_OF_CELLS, SV_STAGE_THRESHOLD, {OWN, WALLS, -1}},
    {K_GATHER,
     BAND,
     BANDS,
     SV_STAGE_RECONSTRUCT,
     {BINS, SUMS, BRIGHTEST, WALLS, INFO, TILES, VOLUME, COUNTS, -1}},
    {K_DECIDE, RECORD, ONCE, SV_STAGE_RECONSTRUCT, {COUNTS, INFO, -1}},
    {K_BLUR, WEIGHTS, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, VOLUME, BLURRED, -1}},
    {K_MINIMUM,
     WEIGHTS | REMEMBERED,
     ROWS_OF_CELLS,
     SV_STAGE_RECONSTRUCT,
     {INFO, BLURRED, PREVIOUS, MINIMA, -1}},
    {K_MEDIAN, 0, ROWS_OF_CELLS, SV_STAGE_RECONSTRUCT, {INFO, MINIMA, VOLUME, -1}},
    {K_UPSAMPLE, MAP_WIDTH | SURFACES, ROWS_OF_PIXELS, SV_STAGE_RECONSTRUCT, {INFO, VOLUME, CONFIDENCE, -1}},
};

static sv_status run(const sv_map *m, sv_method_state *s, uint32_t planes) {
    (void)planes; /* always both: the method is linear in q */
    const sv_cost_layout layout = layout_of(m);
    const size_t count[] = {[ONCE] = 1,
                            [BANDS] = band_count(m, &layout),
                            [ROWS_OF_CELLS] = layout.cells_y,
                            [ROWS_OF_PIXELS] = layout.height};
    const cl_float memory = m->continues ? (cl_float)m->values.of[SV_PARAM_MEMORY] : 0.0f;
    sv_status status = SV_OK;
    for (size_t i = 0; status == SV_OK && i < sizeof launches / sizeof *launches; i++) {
        const int kernel = launches[i].kernel, takes = launches[i].takes;
        sv_launch l = sv_launch_begin(m->queue, s->kernels.kernel[kernel], kernels[kernel]);
        layout_arg(&l, m);
        if (takes & WEIGHTS) weights_arg(&l, m);
        if (takes & REMEMBERED) sv_launch_arg(&l, sizeof memory, &memory);
        if (takes & MAP_WIDTH) sv_launch_uint(&l, m->padded_width);
        if (takes & BAND) sv_launch_uint(&l, band_rows(m, &layout));
        buffer_args(&l, s, launches[i].buffers);
        if (takes & RECORD) sv_launch_buffer(&l, m->record);
        if (takes & SURFACES) sv_launch_buffer(&l, m->surfaces);
        status = sv_launch_items(&l, count[launches[i].items], launches[i].stage);
    }
    return status;
}

static cl_mem confidence(const sv_method_state *s) {
    return s->buffer[CONFIDENCE];
}

static sv_status confidence_report(const sv_map *m, const sv_method_state *s, sv_confidence_report *out) {
    cl_uint info[SV_COST_INFO_WORDS];
    const sv_status status =
        sv_buffer_read(m->queue, s->buffer[INFO], sizeof info, info, "confidence: clEnqueueReadBuffer");
    if (status != SV_OK) return status;
    out->fluid_threshold = (float)info[SV_COST_INFO_LEVEL] / 255.0f;
    out->rays = info[SV_COST_INFO_RAYS];
    out->open_rays = info[SV_COST_INFO_OPEN];
    return SV_OK;
}

const sv_method sv_method_cost = {.definition = &sv_ref_method_cost,
                                  .parameters = SV_USES_EVIDENCE | SV_USES(MEMORY),
                                  .linear = true,
                                  .kernels = kernels,
                                  .source = source,
                                  .buffers = buffers,
                                  .slabs = slabs,
                                  .run = run,
                                  .confidence = confidence,
                                  .confidence_report = confidence_report};
