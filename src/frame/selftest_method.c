/* SPDX-License-Identifier: MIT */
#include "frame/selftest.h"

#include "frame/pipeline.h"
#include "ref/ref_chain.h"
#include "ref/ref_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Small enough for the references (milliseconds), and wider than the widest vector of the profile kernels. */
enum { WIDTH = 67, HEIGHT = 14, SLICES = 24, PIXELS = WIDTH * HEIGHT };
enum { KERNEL = 11, PREFILTER_KERNEL = 3, MERGE = 8 };
static const float Q = 0.25f;

typedef struct {
    uint8_t volume[PIXELS * SLICES], status[PIXELS], expected_status[PIXELS];
    float depth[PIXELS];
    sv_ref_range ranges[PIXELS];
    sv_ref_ray rays[PIXELS];
    double near_end[PIXELS], far_end[PIXELS], points[PIXELS], expected[PIXELS];
} scratch;

/* A point on every 13th ray: fluid from slice `near_end` up to bone at `far_end`. A method that takes the
 * volume wants fluid on many rays, so every second one there, and tissue bright enough that its own T_L lies
 * between the two. */
static void fill(scratch *b, bool for_volume) {
    const uint32_t stride = for_volume ? 2 : 13;
    const uint8_t tissue = for_volume ? 180 : 100;
    for (uint32_t i = 0; i < PIXELS; i++) {
        const uint32_t near_end = 1 + i * 7 % 5, far_end = 8 + i * 11 % 13;
        b->ranges[i] = (sv_ref_range){(uint16_t)(i % 2), (uint16_t)(SLICES - i % 3)};
        for (uint32_t z = 0; z < SLICES; z++)
            b->volume[z * PIXELS + i] =
                i % stride != 4 % stride || z < near_end ? tissue : (uint8_t)(z < far_end ? 0 : 255);
    }
}

/* The initial points by definition, with their depths at q, which the kernels compute in float32. */
static void expect_points(scratch *b, const sv_ref_volume *volume, uint32_t substeps,
                          const sv_values *values) {
    const double *v = values->of;
    const sv_ref_bone bone = {.fluid_threshold = v[SV_PARAM_FLUID_THRESHOLD],
                              .bone_mode = SV_REF_OFFSET,
                              .bone_offset = v[SV_PARAM_BONE_OFFSET]};
    sv_ref_profile(volume, bone.fluid_threshold, substeps, b->rays);
    const uint32_t level = sv_ref_bone_level(b->rays, PIXELS, &bone);
    (void)sv_ref_points(b->rays, PIXELS, &bone, level, b->expected_status, b->near_end, b->far_end);
    for (int i = 0; i < PIXELS; i++) {
        const float near_end = (float)b->near_end[i], far_end = (float)b->far_end[i];
        b->points[i] = (double)(far_end + Q * (near_end - far_end));
    }
}

/* The surface by definition, and how far the device may be from it. False if memory runs out. */
static bool expect(scratch *b, const sv_ref_method *definition, const sv_config *c, bool doubles,
                   const sv_values *values, double *bound) {
    const double *v = values->of;
    const bool filtered = c->prefilter == SV_PREFILTER_MINIMUM;
    const sv_ref_volume volume = {.voxels = b->volume,
                                  .width = WIDTH,
                                  .height = HEIGHT,
                                  .slices = SLICES,
                                  .padding = c->padding < 256 ? (int32_t)c->padding : SV_NO_PADDING,
                                  .scanned = c->ranged ? b->ranges : NULL};
    const sv_ref_settings settings = {
        .kernel = (uint32_t)v[SV_PARAM_KERNEL],
        .fill_weight = v[SV_PARAM_FILL_WEIGHT],
        .lambda = v[SV_PARAM_LAMBDA],
        .merge_grid = c->merge_grid,
        .spline_grid = c->spline_grid,
        .prefilter_passes = filtered ? (uint32_t)v[SV_PARAM_PREFILTER_PASSES] : 0,
        .prefilter_kernel = (uint32_t)v[SV_PARAM_PREFILTER_KERNEL],
    };
    expect_points(b, &volume, c->substeps, values);
    const sv_ref_task task = {.map = {.status = b->expected_status, b->points, WIDTH, HEIGHT},
                              .volume = &volume,
                              .q = (double)Q,
                              .settings = &settings};
    const sv_ref_device device = {.slices = SLICES, .substeps = c->substeps, .doubles = doubles};
    *bound = sv_ref_bound(definition, &task, &device);
    if (!sv_method_uses(sv_method_of(c->method), SV_PARAM_EVIDENCE)) /* no points are looked for */
        memset(b->expected_status, SV_POINT_NONE, sizeof b->expected_status);
    return sv_ref_chain(definition, &task, b->expected);
}

static sv_status compute(sv_pipeline *p, scratch *b, const sv_values *values) {
    const sv_frame_context context = {0};
    sv_pipeline_begin(p, values, &context);
    const sv_slab slab = {
        .size = sizeof slab, .slice_count = SLICES, .memory = b->volume, .bytes = sizeof b->volume};
    sv_status status = SV_OK;
    if (p->config.ranged) status = sv_pipeline_scanned(p, (const sv_scanned *)b->ranges, NULL, 0);
    if (status == SV_OK) status = sv_pipeline_slab(p, &slab);
    return sv_selftest_end(p, status,
                           &(sv_result){.size = sizeof(sv_result), .depth = b->depth, .status = b->status});
}

static sv_status compare(sv_diag *diag, const scratch *b, double bound) {
    for (int i = 0; i < PIXELS; i++)
        if (b->status[i] != b->expected_status[i] || !(fabs((double)b->depth[i] - b->expected[i]) <= bound))
            return sva_error(
                diag, SV_ERR_SELF_TEST,
                "self-test of the method: ray (%d, %d) has status %d and depth %g slices, expected %d "
                "and %g",
                i % WIDTH, i / WIDTH, b->status[i], (double)b->depth[i], b->expected_status[i],
                b->expected[i]);
    return SV_OK;
}

sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                             const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    const sv_method *method = sv_method_of(config->method);
    if (method->takes_sums && config->prefilter == SV_PREFILTER_NONE) return SV_OK;
    const sv_config small = {.width = WIDTH,
                             .height = HEIGHT,
                             .slices = SLICES,
                             .max_slab_slices = SLICES,
                             .tiles_x = 1,
                             .tile_w = WIDTH,
                             .tile_h = HEIGHT,
                             .row_pitch = WIDTH,
                             .carrier = SV_CARRIER_HOST,
                             .padding = config->padding < 256 ? 7 : 256,
                             .ranged = config->ranged,
                             .substeps = config->substeps,
                             .strategy = config->strategy,
                             .method = config->method,
                             .prefilter = config->prefilter,
                             .float32 = config->float32,
                             .merge_grid = MERGE};
    sv_values values = *defaults;
    values.of[SV_PARAM_Q] = (double)Q;
    values.of[SV_PARAM_KERNEL] = KERNEL;
    values.of[SV_PARAM_EVIDENCE] = 0.0; /* the volume is no scan */
    values.of[SV_PARAM_PREFILTER_KERNEL] = PREFILTER_KERNEL;
    scratch *b = calloc(1, sizeof *b);
    if (!b) return sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test (%zu bytes)", sizeof *b);
    fill(b, method->definition->takes_volume);
    sv_pipeline pipeline;
    sv_status status = sv_pipeline_create(&pipeline, diag, device, narrow, wide, NULL, &small);
    if (status == SV_OK) status = compute(&pipeline, b, &values);
    double bound = 0.0;
    if (status == SV_OK && !expect(b, method->definition, &small, pipeline.map.doubles, &values, &bound))
        status = sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test's reference");
    if (status == SV_OK) status = compare(diag, b, bound);
    sv_pipeline_destroy(&pipeline);
    free(b);
    return status;
}
