/* SPDX-License-Identifier: MIT */
#include "bench/bench_lit.h"

#include "base/progress.h"

#include <stdio.h>

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

static bool run_view(const bench *b, const hs_volume *volume, uint32_t frames, const bench_view *view,
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

bool bench_lit_run(const hs_cl *cl, const hs_volume *volume, uint32_t frames, bench_lit_result *out,
                   hs_error *err) {
    bench b = {.cl = cl};
    bool ok = open_bench(&b, volume, err);
    for (int i = 0; ok && i < BENCH_VIEWS; i++)
        ok = run_view(&b, volume, frames, &bench_views[i], &out->view[i], err);
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
