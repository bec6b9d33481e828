/* SPDX-License-Identifier: MIT */
#include "bench/bench_host.h"

#include "bench/bench_slabs.h"

#include <stdio.h>
#include <stdlib.h>

static const double side_mm = 120.0; /* of the layered volume: what a scan of a fetus shows */
static const double rotated_yaw = 30.0, rotated_pitch = 20.0; /* degrees */

bool bench_layered_source(hs_source *source, hs_volume *volume, const hs_volume **list, uint32_t n,
                          hs_error *err) {
    if (!hs_volume_init(volume, n, n, n, err)) return false;
    uint8_t **slice = malloc(n * sizeof *slice);
    if (!slice) return hs_fail(err, HS_ERR_MEMORY, "benchmark volume: no memory for %u slices", n);
    for (uint32_t z = 0; z < n; z++) slice[z] = volume->voxels + (size_t)z * n * n;
    const bool ok = bench_volume_fill(n, n, slice, n, err);
    free(slice);
    (void)snprintf(volume->name, sizeof volume->name, "layered volume");
    for (int k = 0; k < 3; k++) volume->spacing[k] = side_mm / n;
    *list = volume;
    *source = (hs_source){.volumes = list, .count = 1};
    return ok;
}

bool bench_open_source(const char *scene, uint32_t n, hs_source *source, hs_volume *volume,
                       const hs_volume **list, hs_error *err) {
    const hs_source_scene what = {.name = scene, .size = n, .volumes = 1};
    return scene ? hs_source_open_scene(source, &what, err)
                 : bench_layered_source(source, volume, list, n, err);
}

void bench_close_source(const char *scene, hs_source *source, hs_volume *volume) {
    if (scene) hs_source_close(source);
    hs_volume_free(volume);
}

/* The three settings under one camera. */
static bool run_view(const bench_host_setup *setup, const hs_source *source, const char *label, double yaw,
                     double pitch, bool live, bench_view_result *view, uint32_t *lowres, hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = setup->frames;
    options.yaw = yaw;
    options.pitch = pitch;
    options.live = live;
    options.values = setup->values;
    options.value_count = setup->value_count;
    hs_loop *loop = hs_loop_create(setup->cl, source, setup->plugin, &options, err);
    if (!loop) return false;
    view->label = label;
    *lowres = hs_loop_layout(loop)->width;
    bool ok = true;
    for (int s = 0; ok && s < HS_SETTING_COUNT; s++) {
        hs_progress progress;
        hs_progress_begin(&progress, label, setup->frames);
        ok = hs_loop_run(loop, (hs_setting)s, &progress, &view->settings[s], err);
        hs_progress_end(&progress);
    }
    const hs_error *plugin_error = hs_loop_plugin_error(loop);
    if (ok && plugin_error->code != HS_OK) ok = hs_fail(err, plugin_error->code, "%s", plugin_error->text);
    hs_loop_destroy(loop);
    return ok;
}

/* What the loop does not time by itself. */
static bool run_pieces(const bench_host_setup *setup, const hs_volume *volume, bench_host_result *result,
                       hs_error *err) {
    hs_dvr_settings settings;
    hs_dvr_defaults(&settings);
    settings.look = HS_LOOK_THESIS;
    hs_camera camera;
    hs_camera_look(&camera, volume, 0.0, 0.0);
    bench_samples mip = {0}, grid = {0};
    cl_mem gray = NULL;
    hs_dvr *dvr = hs_dvr_create(setup->cl, &settings, err);
    hs_device_volume *device = dvr ? hs_device_volume_create(setup->cl, volume, err) : NULL;
    const size_t bytes = (size_t)settings.width * settings.height;
    bool ok = device && bench_samples_create(&mip, setup->frames, err) &&
              bench_samples_create(&grid, setup->frames, err) &&
              hs_cl_take_buffer(setup->cl, bytes, "benchmark", &gray, err);
    for (uint32_t i = 0; ok && i < setup->frames + 1; i++) { /* the first is not counted */
        const double start = hs_now();
        ok = hs_device_volume_replace(device, volume, err) && hs_dvr_prepare(dvr, device, err) &&
             hs_cl_check(clFinish(setup->cl->queue), "clFinish (benchmark)", err);
        const double placed = hs_now();
        ok = ok && hs_dvr_mip(dvr, device, &camera, gray, NULL, err) &&
             hs_cl_check(clFinish(setup->cl->queue), "clFinish (benchmark)", err);
        const double done = hs_now();
        if (i > 0) bench_samples_add(&grid, (placed - start) * 1e3);
        if (i > 0) bench_samples_add(&mip, (done - placed) * 1e3);
    }
    result->mip = bench_samples_times(&mip);
    result->grid = bench_samples_times(&grid);
    bench_samples_destroy(&mip);
    bench_samples_destroy(&grid);
    if (gray) (void)clReleaseMemObject(gray);
    hs_device_volume_destroy(device);
    hs_dvr_destroy(dvr);
    return ok;
}

bool bench_host_run(const bench_host_setup *setup, bench_host_result *result, hs_error *err) {
    hs_source source = {0};
    hs_volume volume = {0};
    const hs_volume *list[1];
    *result = (bench_host_result){.size = setup->size};
    bool ok = bench_open_source(setup->scene, setup->size, &source, &volume, list, err);
    if (ok) {
        const hs_volume *first = hs_source_volume(&source, 0);
        (void)snprintf(result->volume, sizeof result->volume, "%s", first->name);
        ok =
            run_view(setup, &source, "still camera", 0.0, 0.0, false, &result->still, &result->lowres, err) &&
            run_view(setup, &source, "rotated camera", rotated_yaw, rotated_pitch, false, &result->rotated,
                     &result->lowres, err) &&
            run_view(setup, &source, "still camera, live", 0.0, 0.0, true, &result->live, &result->lowres,
                     err) &&
            run_pieces(setup, first, result, err) &&
            bench_lit_run(setup->cl, first, setup->frames, &result->lit, err);
    }
    bench_close_source(setup->scene, &source, &volume);
    return ok;
}
