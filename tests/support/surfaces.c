/* SPDX-License-Identifier: MIT */
#include "support/surfaces.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const surface_names[METHODS] = {"mean", "minimum", "spline", "pushpull", "membrane", "plate"};

static void *must(void *p) {
    if (!p) abort();
    return p;
}

surface_points surface_points_make(uint32_t width, uint32_t height, uint32_t slices) {
    const size_t count = (size_t)width * height;
    return (surface_points){.width = width,
                            .height = height,
                            .slices = slices,
                            .status = must(calloc(count, 1)),
                            .near_end = must(calloc(count, sizeof(double))),
                            .far_end = must(calloc(count, sizeof(double)))};
}

void surface_points_free(surface_points *points) {
    free(points->status);
    free(points->near_end);
    free(points->far_end);
    memset(points, 0, sizeof *points);
}

void surface_put(surface_points *points, uint32_t x, uint32_t y, uint32_t near_end, uint32_t far_end) {
    assert(near_end < far_end && far_end < points->slices && x < points->width && y < points->height);
    const size_t i = (size_t)y * points->width + x;
    points->status[i] = 1;
    points->near_end[i] = near_end;
    points->far_end[i] = far_end;
}

surface_points surface_scattered(uint32_t width, uint32_t height, uint32_t slices, uint32_t count,
                                 uint32_t seed) {
    surface_points p = surface_points_make(width, height, slices);
    uint32_t random = seed * 2654435761u + 1;
    for (uint32_t n = 0; n < count; n++) {
        const uint32_t x = surface_random(&random) % width, y = surface_random(&random) % height;
        const uint32_t far_end = 1 + surface_random(&random) % (slices - 1);
        surface_put(&p, x, y, surface_random(&random) % far_end, far_end);
    }
    return p;
}

surface_points surface_patches(uint32_t width, uint32_t height, uint32_t slices, uint32_t seed) {
    enum { PATCHES = 6 };
    surface_points p = surface_points_make(width, height, slices);
    const double radius = sqrt(0.03 * width * height / (PATCHES * 3.14159265));
    uint32_t random = seed * 2654435761u + 1;
    for (int n = 0; n < PATCHES; n++) {
        const double x0 = surface_random(&random) % width, y0 = surface_random(&random) % height;
        const double middle = 0.35 * slices + surface_random(&random) % (slices / 2);
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++) {
                const double dx = (x - x0) / radius, dy = (y - y0) / radius;
                if (dx * dx + dy * dy > 1.0) continue;
                const uint32_t far_end = (uint32_t)(middle + 0.08 * slices * (dx * dx - dy));
                surface_put(&p, x, y, far_end / 3, far_end);
            }
    }
    return p;
}

uint8_t *surface_volume(const surface_points *points) {
    const size_t plane = (size_t)points->width * points->height;
    uint8_t *volume = must(malloc(plane * points->slices));
    for (uint32_t z = 0; z < points->slices; z++)
        for (size_t i = 0; i < plane; i++) {
            const bool fluid = points->status[i] && z >= points->near_end[i] && z < points->far_end[i];
            const bool bone = points->status[i] && z >= points->far_end[i];
            volume[z * plane + i] = fluid ? 0 : bone ? 255 : 100;
        }
    return volume;
}

static sv_status run_active(rig *r, const surface_points *points, const uint8_t *volume,
                            const sv_param_value *values, uint32_t count, rig_result *out) {
    const sv_plugin *p = r->plugin;
    const sv_frame frame = {.size = sizeof frame, .values = values, .value_count = count};
    const sv_slab slab = {.size = sizeof slab,
                          .slice_count = points->slices,
                          .memory = volume,
                          .bytes = (uint64_t)points->width * points->height * points->slices};
    const sv_result result = {
        .size = sizeof result, .depth = out->depth, .status = out->status, .stats = &out->stats};
    sv_status status = p->begin(p, &frame);
    if (status == SV_OK) status = p->slab(p, &slab);
    if (status == SV_OK) status = p->end(p, &result);
    if (status >= SV_OK) hs_plugin_points(p, &out->points);
    (void)clFinish(r->queue);
    return status == SV_OK ? out->stats.outcome : status;
}

sv_format surface_format(const surface_points *points, const sv_param_value *values, uint32_t count) {
    return (sv_format){.size = sizeof(sv_format),
                       .width = points->width,
                       .height = points->height,
                       .slices = points->slices,
                       .max_slab_slices = points->slices,
                       .voxel_type = SV_VOXEL_U8,
                       .carrier = SV_CARRIER_HOST,
                       .padding_value = SV_NO_PADDING,
                       .tiles_x = 1,
                       .tile_w = points->width,
                       .tile_h = points->height,
                       .row_pitch = points->width,
                       .values = values,
                       .value_count = count};
}

sv_status surface_run(rig *r, const surface_points *points, const surface_chain *chain, rig_result *out,
                      sv_spline_report *report) {
    const sv_param_value fixed[] = {
        {rig_param(r, "method"), 0, chain->method},
        {rig_param(r, "prefilter"), 0, chain->prefilter_passes > 0},
        {rig_param(r, "merge_grid"), 0, chain->merge_grid},
        {rig_param(r, "spline_grid"), 0, chain->spline_grid},
        {rig_param(r, "precision"), 0, chain->half ? 2 : chain->float32},
        {rig_param(r, "strategy"), 0, chain->strategy},
        {rig_param(r, "reduction"), 0, chain->reduction ? chain->reduction : 1},
    };
    sv_format format = surface_format(points, fixed, sizeof fixed / sizeof *fixed);
    format.context = r->context;
    format.device = r->device;
    format.queue = r->queue;
    const sv_param_value values[] = {
        {rig_param(r, "bone_mode"), 0, SV_REF_ABSOLUTE}, /* a volume without bone must not make its own */
        {rig_param(r, "evidence"), 0, 0.0},              /* a point or two shall do */
        {rig_param(r, "q"), 0, (double)chain->q},
        {rig_param(r, "kernel"), 0, chain->k ? chain->k : 23},
        {rig_param(r, "prefilter_passes"), 0, chain->prefilter_passes},
        {rig_param(r, "prefilter_kernel"), 0, chain->prefilter_k ? chain->prefilter_k : 5},
        {rig_param(r, "lambda"), 0, chain->lambda},
        {rig_param(r, "solver_steps"), 0, chain->solver_steps},
        {rig_param(r, "data_weight"), 0, chain->data_weight > 0.0 ? chain->data_weight : 1.0},
    };
    sv_status status = r->plugin->activate(r->plugin, &format);
    if (status != SV_OK) return status;
    uint8_t *volume = surface_volume(points);
    status = run_active(r, points, volume, values, sizeof values / sizeof *values, out);
    free(volume);
    if (status >= 0 && report && chain->method == SPLINE) {
        const sv_ext_spline *spline = hs_plugin_spline(r->plugin);
        *report = (sv_spline_report){.size = sizeof *report};
        const sv_status read = spline->report(r->plugin, report);
        if (read != SV_OK) status = read;
    }
    r->plugin->deactivate(r->plugin);
    return status;
}

static bool expect_spline(const sv_ref_map *map, const surface_chain *chain, double *surface) {
    const size_t count = (size_t)map->width * map->height;
    double *x = must(malloc(3 * count * sizeof *x)), *y = x + count, *z = y + count;
    const double spacing = map->spacing ? map->spacing : 1.0;
    uint32_t n = sv_ref_merge(map, chain->merge_grid, x, y, z);
    if (chain->merge_grid == 0 && n > 1400) n = sv_ref_merge(map, 37, x, y, z); /* what the solver takes */
    sv_ref_spline spline;
    const bool ok = sv_ref_spline_solve(x, y, z, n, chain->lambda / (spacing * spacing), &spline);
    if (ok && spline.singular) abort();
    if (ok) sv_ref_spline_surface(&spline, map->width, map->height, chain->spline_grid, surface);
    if (ok) sv_ref_spline_free(&spline);
    free(x);
    return ok;
}

/* The chain on a map, without the reduction. */
static bool expect_on(sv_ref_map map, const surface_chain *chain, double *surface) {
    const uint32_t reduction = map.spacing ? map.spacing : 1;
    const uint32_t k = sv_ref_reduced_kernel(chain->k ? chain->k : 23, reduction);
    const uint32_t prefilter_k =
        sv_ref_reduced_kernel(chain->prefilter_k ? chain->prefilter_k : 5, reduction);
    const double weight = chain->data_weight > 0.0 ? chain->data_weight : 1.0;
    double *filtered = must(malloc((size_t)map.width * map.height * sizeof *filtered));
    bool ok = true;
    if (chain->prefilter_passes > 0) {
        ok = sv_ref_minimum_prefilter(&map, prefilter_k, chain->prefilter_passes, filtered);
        map.depth = filtered;
    }
    sv_ref_fill fill;
    if (chain->method == MEAN)
        ok = ok && sv_ref_mean(map.status, map.depth, map.width, map.height, k, 0.5, surface, &fill);
    if (chain->method == MINIMUM) ok = ok && sv_ref_minimum(&map, k, surface, &fill);
    if (chain->method == SPLINE) ok = ok && expect_spline(&map, chain, surface);
    if (chain->method == PUSHPULL) ok = ok && sv_ref_pushpull(&map, surface);
    if (chain->method == MEMBRANE)
        ok = ok && sv_ref_least_energy(&map, sv_ref_membrane_energy, weight, surface);
    if (chain->method == PLATE) ok = ok && sv_ref_least_energy(&map, sv_ref_plate_energy, weight, surface);
    free(filtered);
    return ok;
}

double *surface_expect(const surface_points *points, const surface_chain *chain) {
    const size_t count = (size_t)points->width * points->height;
    const uint32_t reduction = chain->reduction ? chain->reduction : 1;
    const bool least = chain->method == MINIMUM || chain->prefilter_passes > 0;
    double *depth = must(malloc(count * sizeof *depth)), *on_cells = must(malloc(count * sizeof *on_cells));
    double *surface = must(malloc(count * sizeof *surface));
    for (size_t i = 0; i < count; i++) { /* in float32, as the minimum filter gets them: it must be exact */
        const float near_end = (float)points->near_end[i], far_end = (float)points->far_end[i];
        depth[i] = (double)(far_end + chain->q * (near_end - far_end));
    }
    const sv_ref_map map = {
        .status = points->status, .depth = depth, .width = points->width, .height = points->height};
    sv_ref_reduced cells;
    if (reduction == 1) {
        if (!expect_on(map, chain, surface)) abort();
    } else {
        if (!sv_ref_reduce(&map, reduction, least, &cells) || !expect_on(cells.map, chain, on_cells)) abort();
        sv_ref_spread(on_cells, map.width, map.height, reduction, surface);
        sv_ref_reduced_free(&cells);
    }
    free(depth);
    free(on_cells);
    return surface;
}

double surface_error(const rig_result *out, const double *expected, size_t count) {
    double worst = 0.0;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(out->depth[i])) return (double)NAN;
        worst = fmax(worst, fabs((double)out->depth[i] - expected[i]));
    }
    return worst;
}

/* The mean filter with planes of 16 bits: half a step a pass, in each of two planes where depths have a sign,
 * and half a step for merged points, which are no whole samples. */
static double half_bound(const surface_chain *chain, const surface_points *p) {
    const uint32_t reduction = chain->reduction ? chain->reduction : 1;
    const uint32_t k = sv_ref_reduced_kernel(chain->k ? chain->k : 23, reduction);
    const uint32_t passes = sv_ref_pass_limit(sv_ref_reduced_side(p->width, reduction),
                                              sv_ref_reduced_side(p->height, reduction), k);
    const sv_ref_fixed format = sv_ref_half_format(p->slices, 2);
    return (2.0 + fabs((double)chain->q)) * (passes + 1) *
           (ldexp(0.5, -(int)format.fraction) + p->slices * 0x1p-23);
}

double surface_bound(const surface_chain *chain, const surface_points *p) {
    const double ulp = p->slices * 0x1p-24; /* half a float32 step at the largest depth */
    const double spread = chain->reduction > 1 ? 8.0 * ulp : 0.0; /* merging, and bilinear interpolation */
    switch (chain->method) {
    case MINIMUM:
        return spread;
    case PUSHPULL:
        return 8.0 * ulp + spread; /* a few roundings a level, which the next level halves, and the blend */
    case MEAN:
        return fmax(1e-3, chain->half ? half_bound(chain, p) : 0.0) + spread;
    default:
        return 1e-3 + spread;
    }
}

uint32_t surface_random(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}
