/* SPDX-License-Identifier: MIT */
/* What guard and checking layer cost a frame: the same frames with the plugin in this process, in one of its
 * own, and behind the layer, in turns. */
#include "base/paths.h"
#include "bench/bench_results.h"

#include "guarded/guarded.h"
#include "loop/loop_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WARM_UP = 5 };

/* How much longer a frame may take with each than with the plugin alone, at 128^3. */
static const struct {
    const char *name;
    double target_ms;
} ways_beside[BENCH_GUARD_WAYS] = {{"", 0.0}, {"the guard", 0.3}, {"the layer", 0.2}};

/* A plugin opened in one of the ways, with its loop and its times. */
typedef struct {
    hs_plugin plugin;
    hs_loop *loop;
    bench_samples convert, frame;
    float *map;
} way;

/* The library to open: for the layer that of the build folder or of the installation, around the plugin. */
static bool find_library(const bench_guard_setup *setup, int which, char *path, size_t bytes, hs_error *err) {
    static const char *const layers[] = {"smartvis_check.so", "../lib/smartvis/check/smartvis_check.so"};
    char found[1024];
    hs_plugin_find(setup->path, found, sizeof found);
    (void)snprintf(path, bytes, "%s", found);
    if (which != BENCH_CHECKED) return true;
    (void)setenv("SMARTVIS_CHECK_PLUGIN", found, 1);
    for (size_t i = 0; i < sizeof layers / sizeof *layers; i++)
        if (hs_path_beside_program(layers[i], path, bytes) && access(path, R_OK) == 0) return true;
    return hs_fail(err, HS_ERR_PLUGIN, "benchmark: %s: no checking layer", path);
}

static bool open_way(way *w, const bench_guard_setup *setup, int which, const hs_source *source, uint32_t n,
                     hs_error *err) {
    char path[1024];
    hs_guard_options guard;
    hs_loop_options options;
    hs_guard_defaults(&guard);
    guard.choice = which == BENCH_GUARDED ? HS_GUARD_ON : HS_GUARD_OFF;
    hs_loop_defaults(&options);
    options.lowres = n;
    options.values = setup->values;
    options.value_count = setup->value_count;
    options.dvr.width = options.dvr.height = n;
    if (!find_library(setup, which, path, sizeof path, err) ||
        !hs_guarded_open(&w->plugin, path, setup->id, SV_LOG_WARNING, &guard, err))
        return false;
    w->loop = hs_loop_create(setup->cl, source, &w->plugin, &options, err);
    w->map = calloc((size_t)n * n, sizeof *w->map);
    if (!w->map) return hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %u x %u depths", n, n);
    return w->loop && bench_samples_create(&w->convert, setup->frames, err) &&
           bench_samples_create(&w->frame, setup->frames, err);
}

static bool close_way(way *w, hs_error *err) {
    hs_loop_destroy(w->loop);
    bench_samples_destroy(&w->convert);
    bench_samples_destroy(&w->frame);
    free(w->map);
    return !w->plugin.instance || hs_guarded_close(&w->plugin, err);
}

/* One frame's conversion and clipping; the map is read back apart from both times if `map` is not NULL. */
static bool run_frame(way *w, uint32_t index, float *map, double ms[2], hs_error *err) {
    hs_frame frame;
    const double start = hs_now();
    if (!hs_loop_convert(w->loop, index, err)) return false;
    const double converted = hs_now();
    if (!hs_loop_clip(w->loop, index, &frame, map, err)) return false;
    ms[0] = (converted - start) * 1e3;
    ms[1] = (hs_now() - converted) * 1e3;
    const hs_error *failure = hs_loop_plugin_error(w->loop);
    return failure->code == HS_OK || hs_fail(err, failure->code, "%s", failure->text);
}

static bool same_maps(way ways[BENCH_GUARD_WAYS], uint32_t n, hs_error *err) {
    double ms[2];
    for (int i = 0; i < BENCH_GUARD_WAYS; i++)
        if (!run_frame(&ways[i], 0, ways[i].map, ms, err)) return false;
    for (int i = 1; i < BENCH_GUARD_WAYS; i++)
        if (memcmp(ways[0].map, ways[i].map, (size_t)n * n * sizeof(float)) != 0)
            return hs_fail(err, HS_ERR_FAILED, "%u^3: behind %s the plugin's map is another", n,
                           ways_beside[i].name);
    return true;
}

bool bench_guard_run(const bench_guard_setup *setup, uint32_t n, bench_guard_result *result, hs_error *err) {
    way ways[BENCH_GUARD_WAYS] = {0};
    hs_source source = {0};
    hs_volume volume = {0};
    const hs_volume *list[1];
    *result = (bench_guard_result){.n = n};
    bool ok = bench_layered_source(&source, &volume, list, n, err);
    for (int i = 0; ok && i < BENCH_GUARD_WAYS; i++) ok = open_way(&ways[i], setup, i, &source, n, err);
    ok = ok && same_maps(ways, n, err);
    /* In turns, so that whatever else the machine does hits both alike. */
    for (uint32_t i = 0; ok && i < WARM_UP + setup->frames; i++)
        for (int w = 0; ok && w < BENCH_GUARD_WAYS; w++) {
            double ms[2];
            ok = run_frame(&ways[w], i, NULL, ms, err);
            if (!ok || i < WARM_UP) continue;
            bench_samples_add(&ways[w].convert, ms[0]);
            bench_samples_add(&ways[w].frame, ms[1]);
        }
    for (int w = 0; w < BENCH_GUARD_WAYS; w++) {
        result->convert[w] = bench_samples_times(&ways[w].convert);
        result->plugin[w] = bench_samples_times(&ways[w].frame);
        ok = close_way(&ways[w], err) && ok;
    }
    hs_volume_free(&volume);
    return ok;
}

void bench_guard_print_head(void) {
    printf("\nGuard and checking layer: a frame with the plugin in this process, in one of its own, and "
           "behind the "
           "layer, in turns; median (least), milliseconds\n");
    printf("%6s | %-16s %-16s %-16s | %-16s %-16s %-16s | %s\n", "size", "convert", "guarded", "checked",
           "plugin", "guarded", "checked", "guard and layer cost");
}

void bench_guard_print(const bench_guard_result *r) {
    const bench_times *const times[] = {r->convert, r->plugin};
    printf("%4u^3 |", r->n);
    for (int t = 0; t < 2; t++) {
        for (int w = 0; w < BENCH_GUARD_WAYS; w++)
            printf(" %7.3f (%6.3f)", times[t][w].median, times[t][w].min);
        printf(" |");
    }
    for (int w = 1; w < BENCH_GUARD_WAYS; w++) {
        const double median = r->plugin[w].median - r->plugin[BENCH_DIRECT].median;
        const double minimum = r->plugin[w].min - r->plugin[BENCH_DIRECT].min;
        const double target_ms = ways_beside[w].target_ms;
        printf("%s %+.3f (%+.3f)", w > 1 ? ";" : "", median, minimum);
        /* A busy machine can hide it in the medians: the target holds if it does for one of the two. */
        if (r->n == 128)
            printf(", at most %.1f: %s", target_ms,
                   median <= target_ms || minimum <= target_ms ? "holds" : "does not hold");
    }
    printf("\n");
}
