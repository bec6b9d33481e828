/* SPDX-License-Identifier: MIT */
#include "frame/selftest.h"

#include "frame/pipeline.h"
#include "quantise.h"
#include "ref/ref_chain.h"
#include "ref/ref_mean.h"
#include "ref/ref_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The frame's volume: odd sizes, wider than the widest vector, a short last slab; small enough for the scalar
 * reference (milliseconds). The method's is smaller, and comes in one slab of one tile a row. */
enum { WIDTH = 75, HEIGHT = 35, SLICES = 21, SLAB = 8, TILES_X = 3, PIXELS = WIDTH * HEIGHT };
enum { METHOD_WIDTH = 67, METHOD_HEIGHT = 14, METHOD_SLICES = 24 };
enum { SLAB_BYTES = (SLAB + TILES_X - 1) / TILES_X * HEIGHT * TILES_X * WIDTH };
_Static_assert(METHOD_WIDTH *METHOD_HEIGHT *METHOD_SLICES <= SLAB_BYTES, "it has room in a slab");
enum { KERNEL = 11, PREFILTER_KERNEL = 3, MERGE = 8 }; /* several passes on so small a map */
static const double BOUND = 1e-3; /* slices: what docs/numerics.md promises of any device */
static const float Q = 0.25f;

/* Everything a test holds; one allocation. */
typedef struct {
    sv_config config;
    uint8_t volume[PIXELS * SLICES], slab[SLAB_BYTES];
    sv_scanned ranges[PIXELS];
    uint8_t status[PIXELS], expected_status[PIXELS];
    float depth[PIXELS], near_surface[PIXELS], far_surface[PIXELS], surface[PIXELS];
    sv_ref_ray rays[PIXELS];
    double near_end[PIXELS], far_end[PIXELS], points[PIXELS], expected[PIXELS];
    uint32_t near_position[PIXELS], far_position[PIXELS];
} scratch;

static scratch *make_scratch(sv_diag *diag, const sv_config *config, uint32_t width, uint32_t height,
                             uint32_t slices, uint32_t slab_slices, uint32_t tiles_x) {
    scratch *b = calloc(1, sizeof *b);
    if (!b) {
        (void)sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test (%zu bytes)", sizeof *b);
        return NULL;
    }
    b->config = (sv_config){.width = width,
                            .height = height,
                            .slices = slices,
                            .max_slab_slices = slab_slices,
                            .tiles_x = tiles_x,
                            .tile_w = width,
                            .tile_h = height,
                            .row_pitch = tiles_x * width,
                            .carrier = SV_CARRIER_HOST,
                            .padding = config->padding,
                            .ranged = config->ranged,
                            .substeps = config->substeps,
                            .strategy = config->strategy};
    return b;
}

static sv_values make_values(const sv_values *defaults) {
    sv_values values = *defaults;
    values.of[SV_PARAM_Q] = (double)Q;
    values.of[SV_PARAM_KERNEL] = KERNEL;
    values.of[SV_PARAM_EVIDENCE] = 0.0; /* the volume is no scan */
    values.of[SV_PARAM_PREFILTER_KERNEL] = PREFILTER_KERNEL;
    return values;
}

/* ---- on the device */
static void fill_slab(scratch *b, uint32_t first, uint32_t count) {
    const sv_config *c = &b->config;
    for (uint32_t s = 0; s < count; s++)
        for (size_t y = 0; y < c->height; y++)
            memcpy(b->slab + ((size_t)(s / c->tiles_x) * c->tile_h + y) * c->row_pitch +
                       (size_t)(s % c->tiles_x) * c->tile_w,
                   b->volume + ((size_t)(first + s) * c->height + y) * c->width, c->width);
}

/* The slab's memory is used again at once, and maps are read. This is activation: waiting is allowed. */
static sv_status finish(const sv_pipeline *p) {
    return sva_cl_check(p->queue.diag, clFinish(p->queue.device->queue), "self-test: clFinish");
}

/* A frame: both maps, and nothing left on the queue. */
static sv_status compute(sv_pipeline *p, scratch *b, const sv_values *values, bool wide) {
    const sv_config *c = &b->config;
    const sv_frame_context context = {0};
    const sv_result to = {.size = sizeof to, .depth = b->depth, .status = b->status};
    sv_pipeline_begin(p, values, &context);
    if (wide) p->map.program = p->map.wide;
    sv_status status = SV_OK;
    if (c->ranged) status = sv_pipeline_scanned(p, b->ranges, NULL, 0);
    for (uint32_t first = 0; status == SV_OK && first < c->slices; first += c->max_slab_slices) {
        const uint32_t left = c->slices - first,
                       count = left < c->max_slab_slices ? left : c->max_slab_slices;
        fill_slab(b, first, count);
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = first,
                              .slice_count = count,
                              .memory = b->slab,
                              .bytes = SLAB_BYTES};
        status = sv_pipeline_slab(p, &slab);
        if (status == SV_OK) status = finish(p);
    }
    if (status == SV_OK) status = sv_pipeline_end(p);
    if (status == SV_OK) status = sv_pipeline_output(p, &to);
    const sv_status waited = finish(p);
    return status == SV_OK ? waited : status;
}

static sv_status compare(sv_diag *diag, const scratch *b, const char *of, double bound) {
    const int width = (int)b->config.width;
    for (int i = 0; i < width * (int)b->config.height; i++)
        if (b->status[i] != b->expected_status[i] || !(fabs((double)b->depth[i] - b->expected[i]) <= bound))
            return sva_error(
                diag, SV_ERR_SELF_TEST,
                "self-test%s: ray (%d, %d) has status %d and depth %g slices, expected %d and %g", of,
                i % width, i / width, b->status[i], (double)b->depth[i], b->expected_status[i],
                b->expected[i]);
    return SV_OK;
}

/* ---- by definition */
static sv_ref_volume volume_of(const scratch *b) {
    const sv_config *c = &b->config;
    return (sv_ref_volume){.voxels = b->volume,
                           .width = c->width,
                           .height = c->height,
                           .slices = c->slices,
                           .padding = (int32_t)c->padding,
                           .scanned = c->ranged ? b->ranges : NULL};
}

/* The initial points. */
static void expect_points(scratch *b, const double *v) {
    const uint32_t pixels = b->config.width * b->config.height;
    const sv_ref_volume volume = volume_of(b);
    const sv_ref_bone bone = {.fluid_threshold = v[SV_PARAM_FLUID_THRESHOLD],
                              .bone_mode = SV_REF_OFFSET,
                              .bone_offset = v[SV_PARAM_BONE_OFFSET]};
    sv_ref_profile(&volume, bone.fluid_threshold, b->config.substeps, b->rays);
    const uint32_t level = sv_ref_bone_level(b->rays, pixels, &bone);
    (void)sv_ref_points(b->rays, pixels, &bone, level, b->expected_status, b->near_end, b->far_end);
}

/* The mean filter in the device's own numbers. False if memory runs out. */
static bool expect_frame(scratch *b, const double *v, bool wide) {
    const uint32_t substeps = b->config.substeps, kernel = (uint32_t)v[SV_PARAM_KERNEL];
    expect_points(b, v);
    for (size_t i = 0; i < PIXELS; i++) {
        b->near_position[i] = (uint32_t)(b->near_end[i] * substeps + 0.5);
        b->far_position[i] = (uint32_t)(b->far_end[i] * substeps + 0.5);
    }
    sv_fixed format = sv_fixed_format(WIDTH, HEIGHT, SLICES, kernel, 2);
    format.wide = wide;
    sv_ref_fill fill;
    if (!sv_ref_mean_fixed(b->expected_status, b->near_position, b->far_position, WIDTH, HEIGHT, kernel,
                           v[SV_PARAM_FILL_WEIGHT], substeps, format, b->near_surface, b->far_surface, &fill))
        return false;
    sv_ref_blend(b->near_surface, b->far_surface, PIXELS, Q, b->surface);
    for (size_t i = 0; i < PIXELS; i++) b->expected[i] = (double)b->surface[i];
    return true;
}

/* The surface of a method, and how far the device may be from it. Kernels compute a point's depth at q in
 * float32. False if memory runs out. */
static bool expect_method(scratch *b, const sv_ref_method *definition, bool doubles, const double *v,
                          double *bound) {
    const sv_config *c = &b->config;
    const bool filtered = c->prefilter == SV_PREFILTER_MINIMUM;
    const sv_ref_volume volume = volume_of(b);
    const sv_ref_settings settings = {
        .kernel = (uint32_t)v[SV_PARAM_KERNEL],
        .fill_weight = v[SV_PARAM_FILL_WEIGHT],
        .passes = (uint32_t)v[SV_PARAM_PASSES],
        .lambda = v[SV_PARAM_LAMBDA],
        .merge_grid = c->merge_grid,
        .spline_grid = c->spline_grid,
        .prefilter_passes = filtered ? (uint32_t)v[SV_PARAM_PREFILTER_PASSES] : 0,
        .prefilter_kernel = (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
    };
    expect_points(b, v);
    for (uint32_t i = 0; i < c->width * c->height; i++) {
        const float near_end = (float)b->near_end[i], far_end = (float)b->far_end[i];
        b->points[i] = (double)(far_end + Q * (near_end - far_end));
    }
    const sv_ref_task task = {.map = {.status = b->expected_status, b->points, c->width, c->height},
                              .volume = &volume,
                              .q = (double)Q,
                              .settings = &settings};
    const sv_ref_device device = {.slices = c->slices, .substeps = c->substeps, .doubles = doubles};
    *bound = sv_ref_bound(definition, &task, &device);
    if (!sv_method_uses(sv_method_of(c->method), SV_PARAM_EVIDENCE)) /* no points are looked for */
        memset(b->expected_status, SV_POINT_NONE, sizeof b->expected_status);
    return sv_ref_chain(definition, &task, b->expected);
}

static sv_status no_reference(sv_diag *diag) {
    return sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test's reference");
}

/* ---- the frame's test */
/* Layers of tissue, fluid and bone that vary from ray to ray, with some unscanned voxels and exact
 * thresholds; rays that begin and end everywhere, beyond the volume, too; and some of which nothing was
 * scanned. */
static void fill_layers(scratch *b) {
    uint32_t random = 12345;
    for (size_t z = 0; z < SLICES; z++)
        for (size_t i = 0; i < PIXELS; i++) {
            random = random * 1664525u + 1013904223u;
            const uint32_t noise = random >> 24;
            uint32_t value = z % 7 < 3 + i % 3 ? 20 + noise % 22 : 40 + noise % 120;
            if (i % 13 == z && noise < 60) value = 255 - noise % 5;
            if (sv_is_padded(&b->config) && (z < i % 4 || noise > 250)) value = b->config.padding;
            b->volume[z * PIXELS + i] = (uint8_t)value;
        }
    for (size_t i = 0; i < PIXELS; i++)
        b->ranges[i] = (sv_scanned){(uint16_t)(i % 17 == 3 ? 30 : i * 5 % 11),
                                    (uint16_t)(i % 19 == 7 ? 4 : SLICES + 3 - i * 3 % 13)};
}

sv_status sv_selftest(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                      const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    const sv_values values = make_values(defaults);
    scratch *b = make_scratch(diag, config, WIDTH, HEIGHT, SLICES, SLAB, TILES_X);
    if (!b) return SV_ERR_NO_MEMORY;
    fill_layers(b);
    sv_pipeline pipeline;
    sv_status status = sv_pipeline_create(&pipeline, diag, device, narrow, wide, NULL, &b->config);
    for (int set = 0; status == SV_OK && set < (wide ? 2 : 1); set++) {
        status = compute(&pipeline, b, &values, set == 1);
        if (status == SV_OK && !expect_frame(b, values.of, set == 1)) status = no_reference(diag);
        if (status == SV_OK) status = compare(diag, b, "", BOUND);
    }
    sv_pipeline_destroy(&pipeline);
    free(b);
    return status;
}

/* ---- the method's test */
/* A point on every 13th ray: fluid from slice `near_end` up to bone at `far_end`. A method that takes the
 * volume wants fluid on many rays, so every second one there, and tissue bright enough that its own T_L lies
 * between the two. */
static void fill_points(scratch *b, bool for_volume) {
    const uint32_t stride = for_volume ? 2 : 13, pixels = METHOD_WIDTH * METHOD_HEIGHT;
    const uint8_t tissue = for_volume ? 180 : 100;
    for (uint32_t i = 0; i < pixels; i++) {
        const uint32_t near_end = 1 + i * 7 % 5, far_end = 8 + i * 11 % 13;
        b->ranges[i] = (sv_scanned){(uint16_t)(i % 2), (uint16_t)(METHOD_SLICES - i % 3)};
        for (uint32_t z = 0; z < METHOD_SLICES; z++)
            b->volume[z * pixels + i] =
                i % stride != 4 % stride || z < near_end ? tissue : (uint8_t)(z < far_end ? 0 : 255);
    }
}

sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    const sv_method *method = sv_method_of(config->method);
    if (method->takes_sums && config->prefilter == SV_PREFILTER_NONE) return SV_OK;
    const sv_values values = make_values(defaults);
    scratch *b = make_scratch(diag, config, METHOD_WIDTH, METHOD_HEIGHT, METHOD_SLICES, METHOD_SLICES, 1);
    if (!b) return SV_ERR_NO_MEMORY;
    b->config.padding = sv_is_padded(config) ? 7 : SV_UNPADDED;
    b->config.method = config->method;
    b->config.prefilter = config->prefilter;
    b->config.float32 = config->float32;
    b->config.merge_grid = MERGE;
    fill_points(b, method->definition->takes_volume);
    sv_pipeline pipeline;
    sv_status status = sv_pipeline_create(&pipeline, diag, device, narrow, wide, NULL, &b->config);
    if (status == SV_OK) status = compute(&pipeline, b, &values, false);
    double bound = 0.0;
    if (status == SV_OK && !expect_method(b, method->definition, pipeline.map.doubles, values.of, &bound))
        status = no_reference(diag);
    if (status == SV_OK) status = compare(diag, b, " of the method", bound);
    sv_pipeline_destroy(&pipeline);
    free(b);
    return status;
}
