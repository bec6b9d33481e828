/* SPDX-License-Identifier: MIT */
/* How the time of a plugin's frame grows with voxels, and that of a picture with pixels: exponents, and
 * whether there is a step at some size. */
#include "base/progress.h"
#include "bench/bench_results.h"

#include <math.h>
#include <stdio.h>

#define GROWTH_SCENE "D01"

enum { MAX_SIZES = 7, GROWTH_SLAB = 32, GROWTH_VOLUME = 256 };

/* A frame's least processor time at a size: other programs on the machine change it least. */
typedef struct {
    const char *what;
    uint32_t count, side[MAX_SIZES];
    int axes; /* a side's power: voxels 3, pixels 2 */
    double ms[MAX_SIZES], wall[MAX_SIZES];
} series;

/* The slope of log ms over log count, by least squares over the sizes from `first` on. */
static double exponent(const series *s, uint32_t first) {
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (uint32_t i = first; i < s->count; i++) {
        const double x = s->axes * log((double)s->side[i]), y = log(s->ms[i]);
        n += 1.0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* Each size's exponent from the one before it. */
static void print_series(const series *s) {
    printf("\n%s: least milliseconds of processor time (and by the wall clock)\n", s->what);
    for (uint32_t i = 0; i < s->count; i++) {
        const double local =
            i ? log(s->ms[i] / s->ms[i - 1]) / (s->axes * log((double)s->side[i] / s->side[i - 1])) : 0.0;
        printf("%5u^%d %10.3f (%9.3f) %8.3f ns each", s->side[i], s->axes, s->ms[i], s->wall[i],
               1e6 * s->ms[i] / pow(s->side[i], s->axes));
        if (i) printf("   exponent %.2f", local);
        printf("\n");
    }
    printf("exponent over all: %.2f; of the larger half: %.2f\n", exponent(s, 0), exponent(s, s->count / 2));
}

/* ---------------------------------------------------------------------------------------------- voxels -- */

static bool time_size(const bench_plugin_setup *setup, const char *method, uint32_t n, double *ms,
                      double *wall, hs_error *err) {
    const bench_plugin_setup own = {.plugin = setup->plugin,
                                    .cl = setup->cl,
                                    .team = setup->team,
                                    .frames = setup->frames,
                                    .values = setup->values,
                                    .value_count = setup->value_count,
                                    .method = method};
    const bench_variant variant = {n, 23, GROWTH_SLAB, BENCH_PLACE_OWN};
    bench_plugin_result result;
    bench_slabs slabs;
    if (!bench_slabs_create(&slabs, n, GROWTH_SLAB, err)) return false;
    const bool ok = bench_plugin_run(&own, &slabs, &variant, NULL, &result, err);
    *ms = result.processor.min;
    *wall = result.times[BENCH_FRAME].min;
    bench_slabs_destroy(&slabs);
    return ok;
}

/* Powers of two and between them; and neighbours, which tell what odd sides and started vectors cost. */
static const uint32_t sides[2][MAX_SIZES] = {{64, 96, 128, 192, 256, 384, 512},
                                             {120, 127, 128, 129, 133, 144, 160}};

static bool run_voxels(const bench_plugin_setup *setup, const char *method, int which, hs_error *err) {
    char what[64];
    series s = {.what = what, .count = MAX_SIZES, .axes = 3};
    (void)snprintf(what, sizeof what, "a frame of %s, by voxels", method);
    for (uint32_t i = 0; i < s.count; i++) {
        s.side[i] = sides[which][i];
        if (!time_size(setup, method, s.side[i], &s.ms[i], &s.wall[i], err)) return false;
    }
    print_series(&s);
    return true;
}

/* ---------------------------------------------------------------------------------------------- pixels -- */

static bool time_pictures(const hs_cl *cl, const hs_device_volume *volume, const hs_camera *camera,
                          uint32_t side, uint32_t frames, double *ms, double *wall, hs_error *err) {
    hs_dvr_settings settings;
    bench_picture picture = {0};
    hs_dvr_defaults(&settings);
    settings.look = HS_LOOK_LIT;
    settings.width = settings.height = side;
    hs_dvr *dvr = hs_dvr_create(cl, &settings, err);
    bool ok = dvr && bench_picture_create(&picture, cl, &settings, err);
    for (uint32_t i = 0; ok && i <= frames; i++) { /* the first is not counted */
        const double begin = hs_now(), busy = bench_processor_ms();
        ok =
            bench_picture_draw(&picture, dvr, volume, camera, true, err) && bench_picture_wait(&picture, err);
        const double took = (hs_now() - begin) * 1e3, processor = bench_processor_ms() - busy;
        if (i == 1 || (i > 1 && processor < *ms)) *ms = processor;
        if (i == 1 || (i > 1 && took < *wall)) *wall = took;
    }
    bench_picture_destroy(&picture);
    hs_dvr_destroy(dvr);
    return ok;
}

static bool run_pixels(const hs_cl *cl, uint32_t frames, hs_error *err) {
    series s = {.what = "a lit picture of scene " GROWTH_SCENE " at 256^3, clipped, by pixels",
                .count = MAX_SIZES,
                .side = {128, 192, 256, 384, 512, 768, 1024},
                .axes = 2};
    hs_source source = {0};
    hs_volume volume = {0};
    const hs_volume *list[1];
    hs_camera camera;
    if (!bench_open_source(GROWTH_SCENE, GROWTH_VOLUME, &source, &volume, list, err)) return false;
    const hs_volume *first = hs_source_volume(&source, 0);
    hs_device_volume *device = hs_device_volume_create(cl, first, err);
    hs_camera_look(&camera, first, 0.0, 0.0);
    bool ok = device != NULL;
    for (uint32_t i = 0; ok && i < s.count; i++)
        ok = time_pictures(cl, device, &camera, s.side[i], frames, &s.ms[i], &s.wall[i], err);
    if (ok) print_series(&s);
    hs_device_volume_destroy(device);
    bench_close_source(GROWTH_SCENE, &source, &volume);
    return ok;
}

bool bench_growth_run(const bench_plugin_setup *setup, hs_error *err) {
    static const char *const methods[] = {"mean", "wall"};
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
        for (int which = 0; which < 2 && bench_plugin_has_method(setup->plugin, methods[i]); which++)
            if (!run_voxels(setup, methods[i], which, err)) return false;
    return run_pixels(setup->cl, setup->frames, err);
}
