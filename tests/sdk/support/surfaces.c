/* SPDX-License-Identifier: MIT */
#include "support/surfaces.h"

#include <assert.h>
#include <math.h>

int surface_next(int method) {
    while (++method < SV_METHOD_END)
        if (sv_ref_method_of((uint32_t)method)) return method;
    return -1;
}

int surface_next_of_points(int method) {
    do method = surface_next(method);
    while (method >= 0 && sv_ref_method_of((uint32_t)method)->takes_volume);
    return method;
}

const char *surface_name(int method) {
    return sv_ref_method_name((uint32_t)method);
}

surface_points surface_points_make(uint32_t width, uint32_t height, uint32_t slices) {
    const size_t count = (size_t)width * height;
    return (surface_points){.width = width,
                            .height = height,
                            .slices = slices,
                            .status = unit_memory(count),
                            .near_end = unit_memory(count * sizeof(double)),
                            .far_end = unit_memory(count * sizeof(double))};
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
        const uint32_t x = unit_random(&random) % width, y = unit_random(&random) % height;
        const uint32_t far_end = 1 + unit_random(&random) % (slices - 1);
        surface_put(&p, x, y, unit_random(&random) % far_end, far_end);
    }
    return p;
}

surface_points surface_patches(uint32_t width, uint32_t height, uint32_t slices, uint32_t seed) {
    enum { PATCHES = 6 };
    surface_points p = surface_points_make(width, height, slices);
    const double radius = sqrt(0.03 * width * height / (PATCHES * 3.14159265));
    uint32_t random = seed * 2654435761u + 1;
    for (int n = 0; n < PATCHES; n++) {
        const double x0 = unit_random(&random) % width, y0 = unit_random(&random) % height;
        const double middle = 0.35 * slices + unit_random(&random) % (slices / 2);
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
    uint8_t *volume = unit_memory(plane * points->slices);
    for (uint32_t z = 0; z < points->slices; z++)
        for (size_t i = 0; i < plane; i++) {
            const bool fluid = points->status[i] && z >= points->near_end[i] && z < points->far_end[i];
            const bool bone = points->status[i] && z >= points->far_end[i];
            volume[z * plane + i] = fluid ? 0 : bone ? 255 : 100;
        }
    return volume;
}

rig_format surface_format(const rig *r, const surface_points *points, const surface_chain *chain) {
    return (rig_format){.width = points->width,
                        .height = points->height,
                        .slices = points->slices,
                        .tiles_x = 1,
                        .padding = SV_NO_PADDING,
                        .voxel_mm = 1.0f,
                        .fixed = {{rig_param(r, "method"), 0, chain->method},
                                  {rig_param(r, "prefilter"), 0, chain->prefilter_passes > 0},
                                  {rig_param(r, "merge_grid"), 0, chain->merge_grid},
                                  {rig_param(r, "spline_grid"), 0, chain->spline_grid},
                                  {rig_param(r, "precision"), 0, chain->float32},
                                  {rig_param(r, "strategy"), 0, chain->strategy}}};
}

sv_status surface_run(rig *r, const surface_points *points, const surface_chain *chain, rig_result *out) {
    const sv_param_value values[] = {
        {rig_param(r, "bone_mode"), 0, SV_REF_ABSOLUTE}, /* a volume without bone must not make its own */
        {rig_param(r, "evidence"), 0, 0.0},              /* a point or two shall do */
        {rig_param(r, "q"), 0, (double)chain->q},
        {rig_param(r, "kernel"), 0, chain->k ? chain->k : 23},
        {rig_param(r, "prefilter_passes"), 0, chain->prefilter_passes},
        {rig_param(r, "prefilter_kernel"), 0, chain->prefilter_k ? chain->prefilter_k : 5},
        {rig_param(r, "lambda"), 0, chain->lambda},
    };
    const void *mark = unit_mark();
    const rig_format format = surface_format(r, points, chain);
    const stage *t = rig_stage(r, &format, surface_volume(points));
    sv_status status = r->plugin->activate(r->plugin, &t->format);
    if (status != SV_OK) return status;
    status = rig_frame(r, t, values, sizeof values / sizeof *values, out);
    r->plugin->deactivate(r->plugin);
    unit_return(mark);
    return status;
}

static sv_ref_settings settings_of(const surface_chain *chain) {
    sv_ref_settings s = sv_ref_default_settings;
    if (chain->k) s.kernel = chain->k;
    if (chain->prefilter_k) s.prefilter_kernel = chain->prefilter_k;
    s.prefilter_passes = chain->prefilter_passes;
    s.lambda = chain->lambda;
    s.merge_grid = chain->merge_grid;
    s.spline_grid = chain->spline_grid;
    return s;
}

double *surface_expect(const surface_points *points, const surface_chain *chain) {
    const size_t count = (size_t)points->width * points->height;
    double *depth = unit_memory(count * sizeof *depth), *surface = unit_memory(count * sizeof *surface);
    uint8_t *volume = surface_volume(points);
    for (size_t i = 0; i < count; i++) { /* in float32, as the minimum filter gets them: it must be exact */
        const float near_end = (float)points->near_end[i], far_end = (float)points->far_end[i];
        depth[i] = (double)(far_end + chain->q * (near_end - far_end));
    }
    const sv_ref_volume voxels = {.voxels = volume,
                                  .width = points->width,
                                  .height = points->height,
                                  .slices = points->slices,
                                  .padding = SV_NO_PADDING};
    const sv_ref_settings settings = settings_of(chain);
    const sv_ref_task task = {
        .map = {.status = points->status, .depth = depth, .width = points->width, .height = points->height},
        .volume = &voxels,
        .spacing_mm = {1.0, 1.0, 1.0},
        .q = (double)chain->q,
        .settings = &settings};
    if (!sv_ref_chain(sv_ref_method_of((uint32_t)chain->method), &task, surface)) abort();
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

double surface_try(rig *r, const surface_points *points, const surface_chain *chain, const double *expected,
                   rig_result *out) {
    rig_result made = rig_result_make(points->width, points->height);
    const sv_status status = surface_run(r, points, chain, &made);
    if (status != SV_OK) fail_msg("%s: status %d: %s", surface_name(chain->method), status, r->last_log);
    if (!expected) expected = surface_expect(points, chain);
    if (out) *out = made;
    return surface_error(&made, expected, (size_t)points->width * points->height);
}

void surface_check_points(const rig_result *out, const surface_points *points, int method) {
    const bool on_points = method != SV_METHOD_WALL;
    uint32_t resting = 0;
    for (size_t i = 0; i < (size_t)points->width * points->height; i++) {
        assert_int_equal(out->status[i], on_points ? points->status[i] : SV_POINT_NONE);
        resting += out->status[i] != SV_POINT_NONE;
    }
    assert_int_equal(out->stats.points, resting);
    assert_int_equal(out->points.size > 0, on_points);
}

double surface_bound(const surface_chain *chain, const surface_points *points) {
    const sv_ref_settings settings = settings_of(chain);
    const sv_ref_task task = {.map = {.width = points->width, .height = points->height},
                              .q = (double)chain->q,
                              .settings = &settings};
    const sv_ref_device device = {.slices = points->slices, .substeps = 1, .doubles = !chain->float32};
    return sv_ref_bound(sv_ref_method_of((uint32_t)chain->method), &task, &device);
}
