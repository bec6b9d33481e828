/* SPDX-License-Identifier: MIT */
/* The method's part of the self-test: a small map of scattered points, reconstructed on the device and by
 * src/ref/. */
#include "frame/selftest.h"

#include "ref/sv_ref_cost.h"
#include "ref/sv_ref_methods.h"

#include <math.h>
#include <stdlib.h>

/* Small enough for the references (milliseconds), and wider than the widest vector of the profile kernels. */
enum { WIDTH = 67, HEIGHT = 14, SLICES = 24, PIXELS = WIDTH * HEIGHT };
enum { KERNEL = 11, PREFILTER_KERNEL = 3, MERGE = 8 };
static const float Q = 0.25f;

typedef struct {
    uint8_t volume[PIXELS * SLICES], status[PIXELS], expected_status[PIXELS];
    uint8_t tie[PIXELS]; /* pixels that two equal costs can reach: either answer is right */
    float depth[PIXELS];
    double points[PIXELS], filtered[PIXELS], surface[PIXELS], expected[PIXELS], x[PIXELS], y[PIXELS],
        z[PIXELS];
} bench;

/* A point on every 13th ray, or on every second one for the cost volume, which wants fluid on many: fluid
 * from slice `near` up to bone at `far`. */
static void fill(bench *b, uint32_t method) {
    const uint32_t stride = method == SV_METHOD_COST ? 2 : 13;
    const uint8_t tissue =
        method == SV_METHOD_COST ? 180 : 100; /* its T_L lies between the dark and the bright */
    for (uint32_t i = 0; i < PIXELS; i++) {
        const uint32_t near_end = 1 + i * 7 % 5, far_end = 8 + i * 11 % 13;
        b->expected_status[i] = i % stride == 4 % stride;
        for (uint32_t z = 0; z < SLICES; z++)
            b->volume[z * PIXELS + i] =
                !b->expected_status[i] || z < near_end ? tissue : (uint8_t)(z < far_end ? 0 : 255);
        b->points[i] = (double)((float)far_end + Q * ((float)near_end - (float)far_end));
    }
}

static bool expect_spline(bench *b, const sv_ref_map *map) {
    sv_ref_spline spline;
    const uint32_t count = sv_ref_merge(map, MERGE, b->x, b->y, b->z);
    if (!sv_ref_spline_solve(b->x, b->y, b->z, count, 0.0, &spline)) return false;
    sv_ref_spline_surface(&spline, map->width, map->height, 0, b->surface);
    sv_ref_spline_free(&spline);
    return true;
}

static bool expect_cost(bench *b, int32_t padding) {
    const sv_ref_volume volume = {b->volume, WIDTH, HEIGHT, SLICES, padding};
    sv_ref_cost_facts facts;
    if (!sv_ref_cost_surface(&volume, b->x, b->y, b->z, b->tie, &facts)) return false;
    const bool wanted = facts.open > 0 && facts.open * SV_COST_EVIDENCE >= facts.rays;
    for (uint32_t i = 0; i < PIXELS; i++)
        b->expected[i] = wanted ? b->y[i] + (double)Q * (b->x[i] - b->y[i]) : 0.0;
    return true;
}

static bool expect_method(bench *b, sv_ref_map map, const sv_config *c) {
    const uint32_t k = sv_reduced_kernel(KERNEL, c->reduction);
    sv_ref_fill passes;
    if (c->prefilter == SV_PREFILTER_MINIMUM) {
        const uint32_t window = sv_reduced_kernel(PREFILTER_KERNEL, c->reduction);
        if (!sv_ref_minimum_prefilter(&map, window, 1, b->filtered)) return false;
        map.depth = b->filtered;
    }
    switch (c->method) {
    case SV_METHOD_MEAN:
        return sv_ref_mean(map.status, map.depth, map.width, map.height, k, 0.5, b->surface, &passes);
    case SV_METHOD_MINIMUM:
        return sv_ref_minimum(&map, k, b->surface, &passes);
    case SV_METHOD_SPLINE:
        return expect_spline(b, &map);
    case SV_METHOD_PUSHPULL:
        return sv_ref_pushpull(&map, b->surface);
    case SV_METHOD_MEMBRANE:
        return sv_ref_least_energy(&map, sv_ref_membrane_energy, 1.0, b->surface);
    default:
        return sv_ref_least_energy(&map, sv_ref_plate_energy, 1.0, b->surface);
    }
}

static bool expect(bench *b, const sv_config *c) {
    if (c->method == SV_METHOD_COST) return expect_cost(b, c->padding);
    const sv_ref_map map = {.status = b->expected_status, b->points, WIDTH, HEIGHT};
    const bool least = c->method == SV_METHOD_MINIMUM || c->prefilter == SV_PREFILTER_MINIMUM;
    sv_ref_reduced cells;
    if (!sv_ref_reduce(&map, c->reduction, least, &cells)) return false;
    const bool ok = expect_method(b, cells.map, c);
    if (ok) sv_ref_spread(b->surface, WIDTH, HEIGHT, c->reduction, b->expected);
    sv_ref_reduced_free(&cells);
    return ok;
}

static sv_status compute(sv_pipeline *p, bench *b, const sv_values *defaults) {
    sv_values values = *defaults;
    values.of[SV_PARAM_KERNEL] = KERNEL;
    values.of[SV_PARAM_EVIDENCE] = 0.0; /* the volume is no scan */
    values.of[SV_PARAM_PREFILTER_KERNEL] = PREFILTER_KERNEL;
    sv_pipeline_begin(p, &values);
    const sv_slab slab = {
        .size = sizeof slab, .slice_count = SLICES, .memory = b->volume, .bytes = sizeof b->volume};
    sv_status status = sv_pipeline_slab(p, &slab);
    if (status == SV_OK) status = sv_pipeline_end(p, Q);
    const sv_result result = {.size = sizeof result, .depth = b->depth, .status = b->status};
    if (status == SV_OK) status = sv_pipeline_output(p, Q, &result);
    const sv_status waited = sv_clx_check(p->diag, clFinish(p->device->queue), "self-test: clFinish");
    return status == SV_OK ? waited : status;
}

/* Slices; docs/numerics.md. */
static double bound_of(const sv_pipeline *p) {
    const sv_job *j = &p->job;
    if (p->config.half_sums) return 1e-3 + 2.0 * j->pass_limit * 0.5 / (1u << j->fraction);
    return p->chain.doubles ? 1e-3 : 1e-2;
}

static sv_status compare(sv_diag *diag, const bench *b, double bound) {
    for (int i = 0; i < PIXELS; i++)
        if (b->status[i] != b->expected_status[i] ||
            !(b->tie[i] || fabs((double)b->depth[i] - b->expected[i]) <= bound))
            return sv_fail(
                diag, SV_ERR_SELF_TEST,
                "self-test of the method: ray (%d, %d) has status %d and depth %g slices, expected %d "
                "and %g",
                i % WIDTH, i / WIDTH, b->status[i], (double)b->depth[i], b->expected_status[i],
                b->expected[i]);
    return SV_OK;
}

sv_status sv_selftest_method(sv_diag *diag, const sv_device *device, sv_program *narrow, sv_program *wide,
                             const sv_config *config, const sv_values *defaults) {
    if (config->method == SV_METHOD_MEAN && config->prefilter == SV_PREFILTER_NONE && config->reduction == 1)
        return SV_OK;
    const sv_config small = {.width = WIDTH,
                             .height = HEIGHT,
                             .slices = SLICES,
                             .max_slab_slices = SLICES,
                             .tiles_x = 1,
                             .tile_w = WIDTH,
                             .tile_h = HEIGHT,
                             .row_pitch = WIDTH,
                             .carrier = SV_CARRIER_HOST,
                             .padding = config->padding >= 0 ? 7 : SV_NO_PADDING,
                             .substeps = config->substeps,
                             .strategy = config->strategy,
                             .method = config->method,
                             .prefilter = config->prefilter,
                             .float32 = config->float32,
                             .half_sums = config->half_sums,
                             .reduction = config->reduction,
                             .merge_grid = MERGE};
    bench *b = calloc(1, sizeof *b);
    if (!b) return sv_fail(diag, SV_ERR_NO_MEMORY, "no memory for the self-test (%zu bytes)", sizeof *b);
    fill(b, config->method);
    sv_pipeline pipeline;
    sv_status status = sv_pipeline_create(&pipeline, diag, device, narrow, wide, NULL, &small);
    if (status == SV_OK) status = compute(&pipeline, b, defaults);
    if (status == SV_OK && !expect(b, &small))
        status = sv_fail(diag, SV_ERR_NO_MEMORY, "no memory for the self-test's reference");
    if (status == SV_OK) status = compare(diag, b, bound_of(sv_chain_map(&pipeline)));
    sv_pipeline_destroy(&pipeline);
    free(b);
    return status;
}
