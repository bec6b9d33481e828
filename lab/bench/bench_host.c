/* SPDX-License-Identifier: MIT */
#include "base/progress.h"
#include "bench/bench.h"
#include "bench/bench_results.h"
#include "render/dvr.h"

#include <stdio.h>
#include <stdlib.h>

/* -------------------------------------------------------------------------------------------- pictures -- */

/* Where the plane lies, of the box' depth: in the fluid of the benchmark's volume. */
#define BENCH_PICTURE_PLANE 0.28

#define SIDE   2u    /* pixels of the depthmap */
#define SLICES 1000u /* of the low-resolution volume that it is said to be of */

const bench_view bench_views[BENCH_VIEWS] = {{"still camera clipped", 0, 0, true},
                                             {"rotated camera clipped", 30, 20, true},
                                             {"still camera full volume", 0, 0, false},
                                             {"rotated camera full volume", 30, 20, false}};

bool bench_picture_create(bench_picture *p, const hs_cl *cl, const hs_dvr_settings *settings, hs_error *err) {
    const cl_float depth = (cl_float)(BENCH_PICTURE_PLANE * SLICES);
    const size_t bytes = (size_t)settings->width * settings->height * 4;
    *p = (bench_picture){.cl = cl, .start = {.width = SIDE, .height = SIDE, .slices = SLICES}};
    if (!hs_cl_take_buffer(cl, bytes, "picture", &p->pixels, err) ||
        !hs_cl_take_buffer(cl, SIDE * SIDE * sizeof depth, "start depths", &p->start.depth, err))
        return false;
    const cl_int code = clEnqueueFillBuffer(cl->queue, p->start.depth, &depth, sizeof depth, 0,
                                            SIDE * SIDE * sizeof depth, 0, NULL, NULL);
    return hs_cl_check(code, "clEnqueueFillBuffer (benchmark)", err) && bench_picture_wait(p, err);
}

void bench_picture_destroy(bench_picture *p) {
    if (p->pixels) (void)clReleaseMemObject(p->pixels);
    if (p->start.depth) (void)clReleaseMemObject(p->start.depth);
    *p = (bench_picture){0};
}

bool bench_picture_draw(const bench_picture *p, hs_dvr *dvr, const hs_device_volume *volume,
                        const hs_camera *camera, bool clipped, hs_error *err) {
    return hs_dvr_render(dvr, volume, camera, clipped ? &p->start : NULL, p->pixels, NULL, NULL, err);
}

bool bench_picture_wait(const bench_picture *p, hs_error *err) {
    return hs_cl_check(clFinish(p->cl->queue), "clFinish (benchmark)", err);
}

/* ----------------------------------------------------------------------------------------------- looks -- */

typedef struct {
    const hs_cl *cl;
    hs_dvr *dvr[HS_LOOK_COUNT];
    hs_device_volume *volume;
    bench_picture picture;
} bench;

static bool open_bench(bench *b, const hs_volume *volume, hs_error *err) {
    hs_dvr_settings s;
    hs_dvr_defaults(&s);
    for (int look = 0; look < HS_LOOK_COUNT; look++) {
        s.look = (hs_look)look;
        if (!(b->dvr[look] = hs_dvr_create(b->cl, &s, err))) return false;
    }
    b->volume = hs_device_volume_create(b->cl, volume, err);
    return b->volume && bench_picture_create(&b->picture, b->cl, &s, err);
}

static void close_bench(bench *b) {
    bench_picture_destroy(&b->picture);
    hs_device_volume_destroy(b->volume);
    for (int look = 0; look < HS_LOOK_COUNT; look++) hs_dvr_destroy(b->dvr[look]);
}

static bool time_picture(const bench *b, hs_look look, const hs_camera *camera, bool clipped, double *ms,
                         hs_error *err) {
    const double begin = hs_now();
    const bool ok = bench_picture_draw(&b->picture, b->dvr[look], b->volume, camera, clipped, err) &&
                    bench_picture_wait(&b->picture, err);
    *ms = (hs_now() - begin) * 1e3;
    return ok;
}

static bool run_looks(const bench *b, const hs_volume *volume, uint32_t frames, const bench_view *view,
                      bench_lit_view *out, hs_error *err) {
    bench_samples samples[HS_LOOK_COUNT] = {{0}};
    hs_camera camera;
    hs_camera_look(&camera, volume, view->yaw, view->pitch);
    bool ok = true;
    for (int look = 0; look < HS_LOOK_COUNT; look++)
        ok = ok && bench_samples_create(&samples[look], frames, err);
    for (uint32_t i = 0; ok && i <= frames; i++) /* the first is not counted */
        for (int look = 0; ok && look < HS_LOOK_COUNT; look++) {
            double ms = 0.0;
            ok = time_picture(b, (hs_look)look, &camera, view->clipped, &ms, err);
            if (i > 0) bench_samples_add(&samples[look], ms);
        }
    out->label = view->label;
    out->thesis = bench_samples_times(&samples[HS_LOOK_THESIS]);
    out->lit = bench_samples_times(&samples[HS_LOOK_LIT]);
    for (int look = 0; look < HS_LOOK_COUNT; look++) bench_samples_destroy(&samples[look]);
    return ok;
}

/* A new volume and what the looks need of it, in turns: the difference is the lit look's own. */
static bool run_volume(const bench *b, const hs_volume *volume, uint32_t frames, bench_times *out,
                       hs_error *err) {
    bench_samples samples = {0};
    bool ok = bench_samples_create(&samples, frames, err);
    for (uint32_t i = 0; ok && i <= frames; i++) {
        ok = hs_device_volume_replace(b->volume, volume, err) && bench_picture_wait(&b->picture, err);
        const double begin = hs_now();
        ok =
            ok && hs_dvr_prepare(b->dvr[HS_LOOK_LIT], b->volume, err) && bench_picture_wait(&b->picture, err);
        if (i > 0) bench_samples_add(&samples, (hs_now() - begin) * 1e3);
    }
    *out = bench_samples_times(&samples);
    bench_samples_destroy(&samples);
    return ok;
}

static bool bench_lit_run(const hs_cl *cl, const hs_volume *volume, uint32_t frames, bench_lit_result *out,
                          hs_error *err) {
    bench b = {.cl = cl};
    bool ok = open_bench(&b, volume, err);
    for (int i = 0; ok && i < BENCH_VIEWS; i++)
        ok = run_looks(&b, volume, frames, &bench_views[i], &out->view[i], err);
    ok = ok && run_volume(&b, volume, frames, &out->volume, err);
    close_bench(&b);
    return ok;
}

void bench_print_lit(const bench_lit_result *result) {
    printf("Looks, in turns: one picture, milliseconds; ratios of medians (of minima)\n");
    printf("%-28s | %8s %8s | %8s %8s | %s\n", "", "thesis", "min", "lit", "min", "lit / thesis");
    for (int i = 0; i < BENCH_VIEWS; i++) {
        const bench_lit_view *v = &result->view[i];
        printf("%-28s | %8.2f %8.2f | %8.2f %8.2f | %5.2f (%5.2f)\n", v->label, v->thesis.median,
               v->thesis.min, v->lit.median, v->lit.min, v->lit.median / v->thesis.median,
               v->lit.min / v->thesis.min);
    }
    printf("What the lit look makes of a new volume: %.2f (min %.2f)\n", result->volume.median,
           result->volume.min);
}

/* ------------------------------------------------------------------------------------------------ loop -- */

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
