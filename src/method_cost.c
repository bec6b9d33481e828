/*
 * Method cost: every ray pays for every depth, the rays of a neighbourhood together, and the cheapest depth
 * is the surface (docs/cost_volume.md). It asks for no initial points; it takes the slabs themselves, as bins
 * along the rays.
 */
#include "enqueue.h"
#include "kernels_cost.h"
#include "ref/sv_ref_cost.h"

#include <math.h>

enum { K_BINS, K_SURVEY, K_LEVEL, K_RAYS, K_RANKS, K_GATHER, K_BLUR, K_MINIMUM, K_MEDIAN, K_LEAVE };
static const char *const kernels[] = {"cost_bins",   "cost_survey", "cost_level", "cost_rays",
                                      "cost_ranks",  "cost_gather", "cost_blur",  "cost_minimum",
                                      "cost_median", "cost_leave",  NULL};
enum {
    BINS,
    PARTIAL,
    RAYS,
    WALLS,
    HISTOGRAMS, /* 256 words a row of cells: of the bins, then of the maxima */
    COUNTS,
    INFO,
    BONE,
    VOLUME, /* later the smooth minima */
    BLURRED,
    PREVIOUS, /* costs of the frame before */
    MINIMA,
    CONFIDENCE
};

static sv_source source(void) {
    return (sv_source){sv_kernels_cost, sv_kernels_cost_size};
}

static uint32_t commands(const sv_config *c) {
    return c->slices + 9;
}

static sv_ref_cost_layout layout_of(const sv_config *c) {
    return sv_ref_cost_layout_of(c->width, c->height, c->slices);
}

static sv_status create(sv_pipeline *p, sv_method_state *s) {
    const sv_config *c = &p->config;
    const sv_ref_cost_layout l = layout_of(c);
    const size_t plane = (size_t)p->padded_width * c->height, cells = (size_t)l.cells_x * l.cells_y;
    const size_t bytes[] = {[BINS] = l.labels * plane,
                            [PARTIAL] = 2 * plane * sizeof(cl_ushort),
                            [RAYS] = SV_COST_PLANES * plane,
                            [WALLS] = (size_t)p->padded_width * l.cells_y,
                            [HISTOGRAMS] = 256 * (size_t)l.cells_y * sizeof(cl_uint),
                            [COUNTS] = 2 * (size_t)l.cells_y * sizeof(cl_uint),
                            [INFO] = SV_COST_INFO_WORDS * sizeof(cl_uint),
                            [BONE] = 256 * sizeof(cl_float),
                            [VOLUME] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [BLURRED] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [PREVIOUS] = cells * SV_COST_VALUES * sizeof(cl_float),
                            [MINIMA] = cells * 4 * sizeof(cl_float),
                            [CONFIDENCE] = (size_t)c->width * c->height * sizeof(cl_float)};
    sv_status status = SV_OK;
    for (size_t i = 0; i < sizeof bytes / sizeof *bytes; i++)
        s->buffer[i] = sv_clx_buffer(p->diag, p->device, bytes[i], NULL, &status);
    return status;
}

/* The layout as the kernels see it: cost_layout in cl/method_cost.clh. */
static void layout_arg(sv_launch *launch, const sv_pipeline *p) {
    const sv_ref_cost_layout l = layout_of(&p->config);
    const struct {
        cl_uint width, padded_width, height, labels, block, cells_x, cells_y, gap;
        cl_float scale, pitch;
    } layout = {l.width,   p->padded_width, l.height, l.labels,       l.block,
                l.cells_x, l.cells_y,       l.gap,    (float)l.scale, (float)l.pitch};
    sv_launch_arg(launch, sizeof layout, &layout);
}

/* A launch with the layout as its first argument. */
static sv_launch begin(sv_pipeline *p, const sv_method_state *s, int kernel) {
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[kernel], kernels[kernel]);
    layout_arg(&l, p);
    return l;
}

/* The lateral Gaussian at 0 .. SV_COST_REACH cells. */
static void weights_arg(sv_launch *launch, const sv_pipeline *p) {
    const double sigma = layout_of(&p->config).sigma;
    cl_float8 weight = {{0}};
    for (int i = 0; i <= SV_COST_REACH; i++) weight.s[i] = (float)exp(-0.5 * i * i / (sigma * sigma));
    sv_launch_arg(launch, sizeof weight, &weight);
}

/* Buffers of the state as arguments, up to a negative index. */
static void buffer_args(sv_launch *launch, const sv_method_state *s, const int *indices) {
    for (; *indices >= 0; indices++) sv_launch_buffer(launch, s->buffer[*indices]);
}

static sv_status slab(sv_pipeline *p, sv_method_state *s, cl_mem buffer, uint64_t offset,
                      uint32_t slice_count) {
    const sv_config *c = &p->config;
    sv_launch l = sv_launch_begin(p, s->kernels.kernel[K_BINS], kernels[K_BINS]);
    const cl_ulong first_byte = offset;
    sv_launch_buffer(&l, buffer);
    sv_launch_arg(&l, sizeof first_byte, &first_byte);
    const uint32_t padding = c->padding == SV_NO_PADDING ? 256 : (uint32_t)c->padding;
    const uint32_t numbers[] = {c->row_pitch,  c->tiles_x,  c->tile_w, c->tile_h,
                                p->next_slice, slice_count, c->slices, padding};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) sv_launch_uint(&l, numbers[i]);
    layout_arg(&l, p);
    buffer_args(&l, s, (const int[]){PARTIAL, BINS, -1});
    return sv_launch_items(&l, c->height, SV_STAGE_PROFILE);
}

/* From the bins to what every ray came to, and whether there is a surface. */
static sv_status judge_rays(sv_pipeline *p, sv_method_state *s, size_t rows) {
    sv_launch l = begin(p, s, K_SURVEY);
    buffer_args(&l, s, (const int[]){BINS, HISTOGRAMS, -1});
    sv_status status = sv_launch_items(&l, rows, SV_STAGE_THRESHOLD);
    if (status == SV_OK) {
        l = begin(p, s, K_LEVEL);
        buffer_args(&l, s, (const int[]){HISTOGRAMS, INFO, -1});
        status = sv_launch_items(&l, 1, SV_STAGE_THRESHOLD);
    }
    if (status == SV_OK) {
        l = begin(p, s, K_RAYS);
        buffer_args(&l, s, (const int[]){BINS, INFO, RAYS, HISTOGRAMS, COUNTS, -1});
        status = sv_launch_items(&l, rows, SV_STAGE_THRESHOLD);
    }
    if (status != SV_OK) return status;
    l = begin(p, s, K_RANKS);
    buffer_args(&l, s, (const int[]){HISTOGRAMS, COUNTS, INFO, BONE, -1});
    sv_launch_buffer(&l, p->buffers.record);
    return sv_launch_items(&l, 1, SV_STAGE_THRESHOLD);
}

/* The volume of costs, and its least label in every cell. */
static sv_status find_surface(sv_pipeline *p, sv_method_state *s, size_t rows) {
    sv_launch l = begin(p, s, K_GATHER);
    buffer_args(&l, s, (const int[]){BINS, RAYS, INFO, BONE, WALLS, VOLUME, -1});
    sv_status status = sv_launch_items(&l, rows, SV_STAGE_RECONSTRUCT);
    if (status == SV_OK) {
        l = begin(p, s, K_BLUR);
        weights_arg(&l, p);
        buffer_args(&l, s, (const int[]){INFO, VOLUME, BLURRED, -1});
        status = sv_launch_items(&l, rows, SV_STAGE_RECONSTRUCT);
    }
    if (status == SV_OK) {
        l = begin(p, s, K_MINIMUM);
        const cl_float memory = (cl_float)p->values.of[SV_PARAM_MEMORY];
        weights_arg(&l, p);
        sv_launch_arg(&l, sizeof memory, &memory);
        buffer_args(&l, s, (const int[]){INFO, BLURRED, PREVIOUS, MINIMA, -1});
        status = sv_launch_items(&l, rows, SV_STAGE_RECONSTRUCT);
    }
    if (status != SV_OK) return status;
    l = begin(p, s, K_MEDIAN);
    buffer_args(&l, s, (const int[]){INFO, MINIMA, VOLUME, -1});
    return sv_launch_items(&l, rows, SV_STAGE_RECONSTRUCT);
}

static sv_status run(sv_pipeline *p, sv_method_state *s, uint32_t planes) {
    (void)planes; /* both, always: the method is linear in q */
    const size_t rows = layout_of(&p->config).cells_y;
    sv_status status = judge_rays(p, s, rows);
    if (status == SV_OK) status = find_surface(p, s, rows);
    if (status != SV_OK) return status;
    sv_launch l = begin(p, s, K_LEAVE);
    buffer_args(&l, s, (const int[]){INFO, VOLUME, -1});
    sv_launch_buffer(&l, p->buffers.surfaces);
    sv_launch_buffer(&l, s->buffer[CONFIDENCE]);
    return sv_launch_items(&l, p->config.height, SV_STAGE_RECONSTRUCT);
}

sv_status sv_cost_read(sv_pipeline *p, float *confidence, uint32_t *info) {
    const cl_command_queue queue = p->device->queue;
    const sv_method_state *s = &p->chain.state;
    const size_t bytes = (size_t)p->config.width * p->config.height * sizeof *confidence;
    sv_status status = SV_OK;
    if (confidence)
        status = sv_clx_check(
            p->diag,
            clEnqueueReadBuffer(queue, s->buffer[CONFIDENCE], CL_TRUE, 0, bytes, confidence, 0, NULL, NULL),
            "confidence: clEnqueueReadBuffer");
    if (status != SV_OK) return status;
    return sv_clx_check(p->diag,
                        clEnqueueReadBuffer(queue, s->buffer[INFO], CL_TRUE, 0,
                                            SV_COST_INFO_WORDS * sizeof *info, info, 0, NULL, NULL),
                        "confidence: clEnqueueReadBuffer");
}

cl_mem sv_cost_confidence(const sv_pipeline *p) {
    return p->chain.state.buffer[CONFIDENCE];
}

const sv_method sv_method_cost = {.linear = true,
                                  .kernels = kernels,
                                  .source = source,
                                  .commands = commands,
                                  .create = create,
                                  .slab = slab,
                                  .run = run};
