/* SPDX-License-Identifier: MIT */
/* Why a plugin's frame costs more in the scan loop than again and again on one simple volume: one thing is
 * switched after the other, and all ways take turns. */
#include "base/progress.h"
#include "bench/bench_results.h"
#include "bench/plain.h"
#include "loop/loop_run.h"
#include "plugin/loader_param.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define FRAME_SCENE "D01"

enum { WARM_UP = 2, COMMANDS = 20, MAX_VALUES = 16, WAYS = 8, CAMERAS = 2 };
static const struct timespec pause = {.tv_nsec = 5000000}; /* the driver's threads are asleep after it */
static const struct { double yaw, pitch; } cameras[CAMERAS] = {{0.0, 0.0}, {30.0, 20.0}};

typedef enum { HOT, ASLEEP, COLD, LOOP } before;

/* What each way has that the one before has not. Neighbours that differ only in what comes before a frame
 * share a loop. */
static const struct {
    const char *label;
    uint32_t whole; /* the side is cut down to a multiple of so many voxels */
    bool scene;
    hs_fan fan;
    uint32_t slab;
    before how;
} ways[WAYS] = {
    {"layers, slabs of 32, again at once; side a multiple of 32", 32, false, HS_FAN_NOTHING, 32, HOT},
    {"the side that the source gives", 1, false, HS_FAN_NOTHING, 32, HOT},
    {"slabs of 16, as the host cuts them", 1, false, HS_FAN_NOTHING, 16, HOT},
    {"the scanned range of every ray", 1, false, HS_FAN_BEST, 16, HOT},
    {"the voxels of a scene", 1, true, HS_FAN_BEST, 16, HOT},
    {"after 5 ms without work: threads wake up", 1, true, HS_FAN_BEST, 16, ASLEEP},
    {"after reading the source: caches are cold", 1, true, HS_FAN_BEST, 16, COLD},
    {"in the loop: new volume, conversion, lit picture", 1, true, HS_FAN_BEST, 16, LOOP},
};

typedef struct {
    const bench_frame_setup *setup;
    hs_source source[2]; /* layers, the scene */
    hs_volume layers;
    const hs_volume *list[1];
    sv_param_value values[MAX_VALUES + 1];
    uint32_t value_count;
    hs_plugin plugin[WAYS];
    bool opened[WAYS];
    hs_loop *loop[WAYS];
    bench_samples wall[WAYS], processor[WAYS], command;
} bench;

/* By camera and way. Milliseconds of frames in turns. */
typedef struct {
    hs_slab_layout layout[CAMERAS];                          /* of all ways but the first */
    hs_timing wall[CAMERAS][WAYS], processor[CAMERAS][WAYS]; /* processor: of all threads */
    hs_timing command[CAMERAS];                              /* one that does nothing */
} result;

/* Whether the way takes the loop of the one before it. */
static bool shares_loop(int w) {
    return w > 0 && ways[w].whole == ways[w - 1].whole && ways[w].scene == ways[w - 1].scene &&
           ways[w].fan == ways[w - 1].fan && ways[w].slab == ways[w - 1].slab;
}

static hs_loop *loop_of(const bench *b, int w) {
    while (shares_loop(w)) w--;
    return b->loop[w];
}

static bool open_way(bench *b, int w, int camera, hs_error *err) {
    hs_loop_options o;
    if (shares_loop(w)) return true;
    hs_loop_defaults(&o);
    o.frames = b->setup->frames;
    o.yaw = cameras[camera].yaw;
    o.pitch = cameras[camera].pitch;
    o.live = true;
    o.fan = ways[w].fan;
    o.slab_slices = ways[w].slab;
    if (ways[w].whole > 1)
        o.lowres = hs_loop_lowres(&b->source[ways[w].scene], &o) / ways[w].whole * ways[w].whole;
    o.values = b->values;
    o.value_count = b->value_count;
    hs_loop_for_pictures(&o, HS_LOOK_LIT);
    const hs_plugin *own = b->setup->plugin;
    b->opened[w] =
        hs_plugin_open(&b->plugin[w], own->path, own->instance->descriptor->id, SV_LOG_WARNING, err);
    return b->opened[w] &&
           (b->loop[w] = hs_loop_create(b->setup->cl, &b->source[ways[w].scene], &b->plugin[w], &o, err)) &&
           hs_loop_convert(b->loop[w], 0, err);
}

static const double side_mm = 120.0; /* of the layered volume: what a scan of a fetus shows */

/* The benchmark's layers as the host keeps a volume; beside them a scene. */
static bool open_sources(bench *b, hs_error *err) {
    const uint32_t n = b->setup->size;
    const hs_source_scene what = {
        .name = b->setup->scene ? b->setup->scene : FRAME_SCENE, .size = n, .volumes = 1};
    hs_volume *const volume = &b->layers;
    if (!hs_volume_init(volume, n, n, n, err)) return false;
    uint8_t **slice = malloc(n * sizeof *slice);
    if (!slice) return hs_fail(err, HS_ERR_MEMORY, "benchmark volume: no memory for %u slices", n);
    for (uint32_t z = 0; z < n; z++) slice[z] = volume->voxels + (size_t)z * n * n;
    const bool ok = bench_volume_fill(n, n, slice, n, err);
    free(slice);
    (void)snprintf(volume->name, sizeof volume->name, "layered volume");
    for (int k = 0; k < 3; k++) volume->spacing[k] = side_mm / n;
    b->list[0] = volume;
    b->source[0] = (hs_source){.volumes = b->list, .count = 1};
    return ok && hs_source_open_scene(&b->source[1], &what, err);
}

static bool clip(const bench *b, int w, uint32_t index, double *ms, hs_error *err) {
    hs_frame frame;
    const double begin = hs_now();
    if (!hs_loop_clip(loop_of(b, w), index, &frame, NULL, err)) return false;
    *ms = (hs_now() - begin) * 1e3;
    return true;
}

/* What comes before the frame of a way; the same frame, so that no way profits of what another left. */
static bool prepare(const bench *b, int w, uint32_t index, hs_error *err) {
    double ignored;
    if (!clip(b, w, index, &ignored, err)) return false;
    const hs_volume *source = hs_source_volume(&b->source[1], 0);
    if (ways[w].how == ASLEEP) (void)nanosleep(&pause, NULL);
    if (ways[w].how != COLD) return true;
    bench_team_ready(b->setup->team);
    (void)plain_read(b->setup->team, source->voxels, hs_volume_count(source) / 16 * 16);
    bench_team_rest(b->setup->team);
    return true;
}

/* One frame of a way: its time by the wall clock, and the processor time of all threads. */
static bool take_frame(const bench *b, int w, uint32_t index, double *wall, double *processor,
                       hs_error *err) {
    hs_loop *loop = loop_of(b, w);
    hs_frame frame;
    if (ways[w].how == LOOP) {
        /* The stages wait for each other, so that of the plugin can be told from the others. */
        if (!hs_loop_bring(loop, index, err) || !hs_loop_convert(loop, index, err)) return false;
    } else if (!prepare(b, w, index, err)) {
        return false;
    }
    const double busy = bench_processor_ms();
    if (!clip(b, w, index, wall, err)) return false;
    *processor = bench_processor_ms() - busy;
    return ways[w].how != LOOP || hs_loop_frame(loop, HS_SETTING_SMARTVIS, index, &frame, err);
}

/* What a command costs that does nothing. */
static bool time_commands(bench *b, cl_mem word, hs_error *err) {
    const hs_cl *cl = b->setup->cl;
    const cl_uint zero = 0;
    const double begin = hs_now();
    cl_int code = CL_SUCCESS;
    for (int i = 0; i < COMMANDS && code == CL_SUCCESS; i++)
        code = clEnqueueFillBuffer(cl->queue, word, &zero, sizeof zero, 0, sizeof zero, 0, NULL, NULL);
    if (code == CL_SUCCESS) code = clFinish(cl->queue);
    bench_samples_add(&b->command, (hs_now() - begin) * 1e3 / COMMANDS);
    return hs_cl_check(code, "clEnqueueFillBuffer (benchmark)", err);
}

static bool take_turns(bench *b, cl_mem word, hs_error *err) {
    for (uint32_t i = 0; i < WARM_UP + b->setup->frames; i++)
        for (int w = 0; w < WAYS; w++) {
            double wall = 0.0, processor = 0.0;
            if (!take_frame(b, w, i % b->setup->frames, &wall, &processor, err)) return false;
            const hs_error *failure = hs_loop_plugin_error(loop_of(b, w));
            if (failure->code != HS_OK) return hs_fail(err, failure->code, "%s", failure->text);
            if (i < WARM_UP) continue;
            bench_samples_add(&b->wall[w], wall);
            bench_samples_add(&b->processor[w], processor);
            if (w == 0 && !time_commands(b, word, err)) return false;
        }
    return true;
}

static bool run_camera(bench *b, int camera, result *out, hs_error *err) {
    cl_mem word = NULL;
    bool ok = hs_cl_take_buffer(b->setup->cl, sizeof(cl_uint), "benchmark", &word, err) &&
              bench_samples_create(&b->command, b->setup->frames, err);
    for (int w = 0; ok && w < WAYS; w++)
        ok = bench_samples_create(&b->wall[w], b->setup->frames, err) &&
             bench_samples_create(&b->processor[w], b->setup->frames, err) && open_way(b, w, camera, err);
    ok = ok && take_turns(b, word, err);
    out->layout[camera] = ok ? *hs_loop_layout(b->loop[1]) : (hs_slab_layout){0};
    for (int w = 0; w < WAYS; w++) {
        out->wall[camera][w] = bench_samples_times(&b->wall[w]);
        out->processor[camera][w] = bench_samples_times(&b->processor[w]);
        bench_samples_destroy(&b->wall[w]);
        bench_samples_destroy(&b->processor[w]);
        hs_loop_destroy(b->loop[w]);
        if (b->opened[w]) hs_plugin_close(&b->plugin[w]);
        b->loop[w] = NULL;
        b->opened[w] = false;
    }
    out->command[camera] = bench_samples_times(&b->command);
    bench_samples_destroy(&b->command);
    if (word) (void)clReleaseMemObject(word);
    return ok;
}

static void print(const result *r) {
    printf("\nThe plugin's frame on its way into the loop, one thing more a line, in turns; milliseconds\n");
    for (int c = 0; c < CAMERAS; c++) {
        const hs_slab_layout *l = &r->layout[c];
        printf("%u x %u x %u, camera at %g, %g degrees; a command that does nothing: %.3f (min %.3f)\n",
               l->width, l->height, l->slices, cameras[c].yaw, cameras[c].pitch, r->command[c].median,
               r->command[c].min);
        printf("%-58s | %8s %8s %8s %8s | %9s %8s %8s\n", "", "wall", "min", "p95", "more", "processor",
               "min", "more");
        for (int w = 0; w < WAYS; w++) {
            const hs_timing *t = &r->wall[c][w], *p = &r->processor[c][w];
            printf("%-58s | %8.2f %8.2f %8.2f %+8.2f | %9.2f %8.2f %+8.2f\n", ways[w].label, t->median,
                   t->min, t->p95, w ? t->median - t[-1].median : 0.0, p->median, p->min,
                   w ? p->median - p[-1].median : 0.0);
        }
    }
}

bool bench_frame_run(const bench_frame_setup *setup, hs_error *err) {
    bench b = {.setup = setup};
    result out = {0};
    b.value_count = setup->value_count < MAX_VALUES ? setup->value_count : MAX_VALUES;
    for (uint32_t i = 0; i < b.value_count; i++) b.values[i] = setup->values[i];
    bool ok = open_sources(&b, err);
    for (int c = 0; ok && c < CAMERAS; c++) ok = run_camera(&b, c, &out, err);
    if (ok) print(&out);
    if (b.source[1].count > 0) hs_source_close(&b.source[1]);
    hs_volume_free(&b.layers);
    return ok;
}
