/* SPDX-License-Identifier: MIT */
#include "frame/selftest.h"

#include "frame/pipeline.h"
#include "quantise.h"
#include "ref/ref_mean.h"
#include "ref/ref_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Odd sizes, wider than the widest vector, a short last slab; small enough for the
 * scalar reference (milliseconds). */
enum { WIDTH = 75, HEIGHT = 35, SLICES = 21, SLAB = 8, TILES_X = 3, PIXELS = WIDTH * HEIGHT };
enum { SLAB_BYTES = (SLAB + TILES_X - 1) / TILES_X * HEIGHT * TILES_X * WIDTH };
static const double BOUND = 1e-3; /* slices: what docs/numerics.md promises of any device */
static const double Q = 0.25;

/* Everything the test holds; one allocation. */
typedef struct {
    uint8_t volume[PIXELS * SLICES];
    uint8_t slab[SLAB_BYTES];
    sv_ref_range ranges[PIXELS];
    uint8_t status[PIXELS], expected_status[PIXELS];
    float depth[PIXELS], expected_depth[PIXELS], near_surface[PIXELS], far_surface[PIXELS];
    sv_ref_ray rays[PIXELS];
    double near_end[PIXELS], far_end[PIXELS];
    uint32_t near_position[PIXELS], far_position[PIXELS];
} scratch;

/* Layers of tissue, fluid and bone that vary from ray to ray, with some unscanned voxels
 * and exact thresholds. */
static void fill_volume(scratch *b, uint32_t padding) {
    uint32_t random = 12345;
    for (size_t z = 0; z < SLICES; z++)
        for (size_t i = 0; i < PIXELS; i++) {
            random = random * 1664525u + 1013904223u;
            const uint32_t noise = random >> 24;
            uint32_t value = z % 7 < 3 + i % 3 ? 20 + noise % 22 : 40 + noise % 120;
            if (i % 13 == z && noise < 60) value = 255 - noise % 5;
            if (padding < 256 && (z < i % 4 || noise > 250)) value = padding;
            b->volume[z * PIXELS + i] = (uint8_t)value;
        }
}

/* Rays that begin and end everywhere, beyond the volume, too; and some of which nothing was scanned. */
static void fill_ranges(scratch *b) {
    for (size_t i = 0; i < PIXELS; i++) {
        b->ranges[i].first = (uint16_t)(i % 17 == 3 ? 30 : i * 5 % 11);
        b->ranges[i].end = (uint16_t)(i % 19 == 7 ? 4 : SLICES + 3 - i * 3 % 13);
    }
}

static void fill_slab(scratch *b, uint32_t first, uint32_t count) {
    for (uint32_t s = 0; s < count; s++)
        for (size_t y = 0; y < HEIGHT; y++) {
            const size_t row = (size_t)(s / TILES_X) * HEIGHT + y;
            memcpy(b->slab + row * TILES_X * WIDTH + (size_t)(s % TILES_X) * WIDTH,
                   b->volume + ((size_t)(first + s) * HEIGHT + y) * WIDTH, WIDTH);
        }
}

static bool compute_expected(scratch *b, const sv_values *v, const sv_config *c, bool wide) {
    const double fluid = v->of[SV_PARAM_FLUID_THRESHOLD];
    const sv_ref_volume volume = {.voxels = b->volume,
                                  .width = WIDTH,
                                  .height = HEIGHT,
                                  .slices = SLICES,
                                  .padding = c->padding < 256 ? (int32_t)c->padding : SV_NO_PADDING,
                                  .scanned = c->ranged ? b->ranges : NULL};
    const sv_ref_bone bone = {
        .fluid_threshold = fluid, .bone_mode = SV_REF_OFFSET, .bone_offset = v->of[SV_PARAM_BONE_OFFSET]};
    sv_ref_profile(&volume, fluid, c->substeps, b->rays);
    const uint32_t level = sv_ref_bone_level(b->rays, PIXELS, &bone);
    sv_ref_points(b->rays, PIXELS, &bone, level, b->expected_status, b->near_end, b->far_end);
    for (size_t i = 0; i < PIXELS; i++) {
        b->near_position[i] = (uint32_t)(b->near_end[i] * c->substeps + 0.5);
        b->far_position[i] = (uint32_t)(b->far_end[i] * c->substeps + 0.5);
    }
    sv_fixed format = sv_fixed_format(WIDTH, HEIGHT, SLICES, (uint32_t)v->of[SV_PARAM_KERNEL], 2);
    format.wide = wide;
    sv_ref_fill fill;
    if (!sv_ref_mean_fixed(b->expected_status, b->near_position, b->far_position, WIDTH, HEIGHT,
                           (uint32_t)v->of[SV_PARAM_KERNEL], v->of[SV_PARAM_FILL_WEIGHT], c->substeps, format,
                           b->near_surface, b->far_surface, &fill))
        return false;
    sv_ref_blend(b->near_surface, b->far_surface, PIXELS, (float)Q, b->expected_depth);
    return true;
}

sv_status sv_selftest_end(sv_pipeline *p, sv_status status, const sv_result *to) {
    if (status == SV_OK) status = sv_pipeline_end(p);
    if (status == SV_OK) status = sv_pipeline_output(p, to);
    const sv_status waited =
        sva_cl_check(p->queue.diag, clFinish(p->queue.device->queue), "self-test: clFinish");
    return status == SV_OK ? waited : status;
}

static sv_status compute_on_device(sv_pipeline *p, scratch *b, const sv_values *v, bool wide) {
    const sv_frame_context context = {0};
    sv_pipeline_begin(p, v, &context);
    if (wide) p->map.program = p->map.wide;
    sv_status status = SV_OK;
    _Static_assert(sizeof(sv_scanned) == sizeof(sv_ref_range), "ranges are the ABI's, word for word");
    if (p->config.ranged) status = sv_pipeline_scanned(p, (const sv_scanned *)b->ranges, NULL, 0);
    for (uint32_t first = 0; status == SV_OK && first < SLICES; first += SLAB) {
        const uint32_t count = SLICES - first < SLAB ? SLICES - first : SLAB;
        fill_slab(b, first, count);
        const sv_slab slab = {.size = sizeof slab,
                              .first_slice = first,
                              .slice_count = count,
                              .memory = b->slab,
                              .bytes = SLAB_BYTES};
        status = sv_pipeline_slab(p, &slab);
        /* The slab's memory is used again at once. This is activation: waiting is allowed. */
        if (status == SV_OK)
            status = sva_cl_check(p->queue.diag, clFinish(p->queue.device->queue), "self-test: clFinish");
    }
    return sv_selftest_end(p, status,
                           &(sv_result){.size = sizeof(sv_result), .depth = b->depth, .status = b->status});
}

static sv_status compare(sv_diag *diag, const scratch *b) {
    for (int i = 0; i < PIXELS; i++) {
        const double error = fabs((double)b->depth[i] - (double)b->expected_depth[i]);
        if (b->status[i] != b->expected_status[i])
            return sva_error(diag, SV_ERR_SELF_TEST, "self-test: status of ray (%d, %d) is %d, expected %d",
                             i % WIDTH, i / WIDTH, b->status[i], b->expected_status[i]);
        if (!(error <= BOUND))
            return sva_error(diag, SV_ERR_SELF_TEST,
                             "self-test: depth of ray (%d, %d) is %g slices, expected %g", i % WIDTH,
                             i / WIDTH, (double)b->depth[i], (double)b->expected_depth[i]);
    }
    return SV_OK;
}

sv_status sv_selftest(sv_diag *diag, const sv_device *device, const sv_program *narrow,
                      const sv_program *wide, const sv_config *config, const sv_values *defaults) {
    sv_config small = {.width = WIDTH,
                       .height = HEIGHT,
                       .slices = SLICES,
                       .max_slab_slices = SLAB,
                       .tiles_x = TILES_X,
                       .tile_w = WIDTH,
                       .tile_h = HEIGHT,
                       .row_pitch = TILES_X * WIDTH,
                       .carrier = SV_CARRIER_HOST,
                       .padding = config->padding,
                       .ranged = config->ranged,
                       .substeps = config->substeps,
                       .strategy = config->strategy};
    scratch *b = calloc(1, sizeof *b);
    if (!b) return sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test (%zu bytes)", sizeof *b);
    sv_values values = *defaults;
    values.of[SV_PARAM_Q] = Q;
    values.of[SV_PARAM_KERNEL] = 11.0;  /* small enough that the small map needs several passes */
    values.of[SV_PARAM_EVIDENCE] = 0.0; /* the volume is no scan */
    fill_volume(b, config->padding);
    fill_ranges(b);
    sv_pipeline pipeline;
    sv_status status = sv_pipeline_create(&pipeline, diag, device, narrow, wide, NULL, &small);
    for (int set = 0; status == SV_OK && set < (wide ? 2 : 1); set++) {
        status = compute_on_device(&pipeline, b, &values, set == 1);
        if (status == SV_OK && !compute_expected(b, &values, &small, set == 1))
            status = sva_error(diag, SV_ERR_NO_MEMORY, "no memory for the self-test's reference");
        if (status == SV_OK) status = compare(diag, b);
    }
    sv_pipeline_destroy(&pipeline);
    free(b);
    return status;
}
