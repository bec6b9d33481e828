/* SPDX-License-Identifier: MIT */
/* Times a plugin's frame beside the plain C frame, in turns. */
#include "bench/bench_results.h"
#include "bench/plain.h"
#include "plugin/loader_param.h"
#include "stage/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARM_UP = 5, STAGE_FRAMES = 20, OWN_VALUES = 3 };
static const double tolerance = 1e-3; /* slices */
static const double default_q = 0.25, other_q = 0.75;
static const double bone_offset = 0.24;
#define PLAIN_METHOD "mean" /* what plain C computes */

/* One variant under way. Zeroed: nothing to free. */
typedef struct {
    const bench_plugin_setup *setup;
    const bench_variant *variant;
    const sv_plugin *instance;
    bool active, host_queue;
    stage stage;
    plain_volume volume; /* the stage's slabs */
    float *depth, *plain_depth;
    uint8_t *plain_status;
    sv_param_value values[OWN_VALUES];
    uint32_t value_count;
    bool method_set;
    uint32_t q_id; /* 0: the plugin has no such knob, and adjust is not timed */
    plain_frame *plain;
    bench_samples samples[BENCH_PARTS];
    sv_points_report points;
} bench;

static const struct {
    const char *key, *label;
    bool host_queue, in_place;
} routes[BENCH_ROUTES] = {
    {"place-own", "host memory in place, own queue", false, true},
    {"place-host", "host memory in place, host's queue", true, true},
    {"copy-own", "host memory copied, own queue", false, false},
    {"copy-host", "host memory copied, host's queue", true, false},
    {"buffer-host", "OpenCL buffer, host's queue", true, false},
};

const char *bench_route_label(bench_route route) {
    return routes[route].label;
}
const char *bench_route_key(bench_route route) {
    return routes[route].key;
}

static bool method_value(const hs_plugin *plugin, const char *method, sv_param_value *out, hs_error *err) {
    char text[64];
    (void)snprintf(text, sizeof text, "method=%.40s", method);
    return hs_plugin_parse_param(plugin, text, out, err);
}

bool bench_plugin_has_method(const hs_plugin *plugin, const char *method) {
    sv_param_value value;
    hs_error none = {0};
    return method_value(plugin, method, &value, &none);
}

bool bench_plugin_is_foreign(const hs_plugin *plugin) {
    sv_param_info info = {.size = sizeof info};
    return !hs_plugin_find_param(plugin, "q", &info) || !hs_plugin_find_param(plugin, "kernel", &info);
}

hs_handover bench_route_handover(bench_route route) {
    return (hs_handover){route == BENCH_BUFFER_HOST ? SV_CARRIER_BUFFER : SV_CARRIER_HOST,
                         !routes[route].host_queue};
}

/* The benchmark's own values, q and the window, where the plugin has such parameters. */
static void own_values(bench *b) {
    const hs_plugin *plugin = b->setup->plugin;
    sv_param_info q = {.size = sizeof q}, kernel = {.size = sizeof kernel};
    if (!hs_plugin_find_param(plugin, "q", &q) || !hs_plugin_find_param(plugin, "kernel", &kernel)) return;
    b->q_id = q.id;
    b->values[b->value_count++] = (sv_param_value){.id = q.id, .value = default_q};
    b->values[b->value_count++] = (sv_param_value){.id = kernel.id, .value = b->variant->k};
}

/* The benchmark's own values, and the method, which is one of activate, too. */
static bool make_values(bench *b, hs_error *err) {
    const bench_plugin_setup *s = b->setup;
    own_values(b);
    const char *const method = s->method ? s->method : PLAIN_METHOD;
    const bool named =
        s->method ? strcmp(method, BENCH_OWN) != 0 : bench_plugin_has_method(s->plugin, method);
    if (!named) return true;
    b->method_set = true;
    return method_value(s->plugin, method, &b->values[b->value_count++], err);
}

/* What the stage cannot have ends the program: there is nothing to time without it. */
static void cannot_have(void *data, const char *what, cl_int code) {
    (void)data;
    (void)fprintf(stderr, "sv_bench: no memory for %s (%d)\n", what, (int)code);
    exit(HS_ERR_MEMORY);
}

/* Tiles as square as the host's scan loop lays them. The method, the last of the values, is one of activate,
 * too. */
static void make_stage(bench *b, const uint8_t *voxels) {
    const uint32_t n = b->variant->n, length = b->variant->slab_slices;
    const hs_cl *cl = b->setup->cl;
    const bench_route route = b->variant->route;
    const stage_device device = {cl->device, cl->context, cl->queue};
    stage_way way = {.width = n,
                     .height = n,
                     .slices = n,
                     .longest = length,
                     .tiles_x = (uint32_t)ceil(sqrt(length)),
                     .carrier = route == BENCH_BUFFER_HOST ? SV_CARRIER_BUFFER : SV_CARRIER_HOST,
                     .own_queue = !b->host_queue,
                     .registered = routes[route].in_place,
                     .padding = SV_NO_PADDING,
                     .depth_object = b->host_queue,
                     .fixed_count = b->method_set ? 1 : 0};
    if (b->method_set) way.fixed[0] = b->values[b->value_count - 1];
    stage_make(&b->stage, &way, &device, cannot_have, NULL);
    stage_fill(&b->stage, voxels, NULL);
    stage_poison(&b->stage, 0);
    b->stage.frame_flags = 0;
}

static bool make_memory(bench *b, hs_error *err) {
    const uint32_t n = b->variant->n;
    const size_t rays = (size_t)n * n;
    const sv_format *f = &b->stage.format;
    const plain_settings settings = {.fluid_level = BENCH_FLUID_LEVEL,
                                     .bone_drop = (uint8_t)ceil(bone_offset * 255.0),
                                     .k = b->variant->k,
                                     .q = (float)default_q};
    b->volume = (plain_volume){n, n, n, calloc(n, sizeof *b->volume.slice), f->row_pitch};
    b->depth = calloc(rays, sizeof *b->depth);
    b->plain_depth = calloc(rays, sizeof *b->plain_depth);
    b->plain_status = calloc(rays, 1);
    if (!b->volume.slice || !b->depth || !b->plain_depth || !b->plain_status)
        return hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %zu rays", rays);
    for (uint32_t z = 0; z < n; z++) {
        const uint32_t at = z % b->variant->slab_slices;
        b->volume.slice[z] = b->stage.memory[z / b->variant->slab_slices] +
                             (size_t)(at / f->tiles_x) * f->tile_h * f->row_pitch +
                             at % f->tiles_x * f->tile_w;
    }
    for (int p = 0; p < BENCH_PARTS; p++)
        if (!bench_samples_create(&b->samples[p], b->setup->frames, err)) return false;
    b->plain = plain_frame_create(n, n, n, &settings, err);
    return b->plain;
}

static bool activate(bench *b, hs_error *err) {
    b->active = hs_plugin_check(b->setup->plugin, b->instance->activate(b->instance, &b->stage.format),
                                "activate", err);
    return b->active;
}

static sv_status give_slabs(const bench *b) {
    sv_status status = SV_OK;
    for (uint32_t i = 0; i < b->stage.slab_count && status == SV_OK; i++) {
        const sv_slab slab = stage_slab(&b->stage, i);
        status = b->instance->slab(b->instance, &slab);
    }
    return status;
}

/* With the host's queue a result is there when the queue has run. */
static bool finish(const bench *b, hs_error *err) {
    return !b->host_queue || hs_cl_check(clFinish(b->setup->cl->queue), "clFinish (benchmark)", err);
}

/* One frame; `status_map` too if asked. Leaves milliseconds in ms, which may be NULL. */
static bool plugin_frame(bench *b, bool status_map, double ms[BENCH_PARTS], hs_error *err) {
    const hs_plugin *p = b->setup->plugin;
    const sv_frame frame = stage_frame(&b->stage, b->values, b->value_count);
    sv_result result = stage_result(&b->stage);
    if (!status_map) result.status = NULL;
    const double start = hs_now();
    if (!hs_plugin_check(p, b->instance->begin(b->instance, &frame), "begin", err)) return false;
    const double begun = hs_now();
    if (!hs_plugin_check(p, give_slabs(b), "slab", err)) return false;
    const double given = hs_now();
    if (!hs_plugin_check(p, b->instance->end(b->instance, &result), "end", err) || !finish(b, err))
        return false;
    const double ended = hs_now();
    hs_plugin_points(b->instance, &b->points);
    if (!finish(b, err)) return false;
    if (!ms) return true;
    ms[BENCH_BEGIN] = (begun - start) * 1e3;
    ms[BENCH_SLABS] = (given - begun) * 1e3;
    ms[BENCH_END] = (ended - given) * 1e3;
    ms[BENCH_FRAME] = (ended - start) * 1e3;
    return true;
}

static bool plugin_adjust(bench *b, double *ms, hs_error *err) {
    const sv_param_value q = {.id = b->q_id, .value = other_q};
    sv_result result = stage_result(&b->stage);
    result.status = NULL;
    const double start = hs_now();
    if (!hs_plugin_check(b->setup->plugin, b->instance->adjust(b->instance, &q, 1, &result), "adjust", err) ||
        !finish(b, err))
        return false;
    *ms = (hs_now() - start) * 1e3;
    return true;
}

/* A frame that is given up behind its last slab, until nothing of it runs any more: with the plugin's own
 * queue the next begin waits. */
static bool plugin_dropped(bench *b, double *ms, hs_error *err) {
    const hs_plugin *p = b->setup->plugin;
    const sv_frame frame = stage_frame(&b->stage, b->values, b->value_count);
    const double start = hs_now();
    if (!hs_plugin_check(p, b->instance->begin(b->instance, &frame), "begin", err) ||
        !hs_plugin_check(p, give_slabs(b), "slab", err) || !finish(b, err) ||
        !hs_plugin_check(p, b->instance->begin(b->instance, &frame), "begin", err))
        return false;
    *ms = (hs_now() - start) * 1e3;
    return true;
}

static bool time_plain(bench *b, double *ms, hs_error *err) {
    return plain_frame_run(b->plain, &b->volume, b->plain_depth, b->plain_status, ms, err);
}

/* Plain C and the plugin must come to the same map. */
static bool verify(bench *b, double *difference, hs_error *err) {
    const size_t rays = (size_t)b->variant->n * b->variant->n;
    if (!plugin_frame(b, true, NULL, err)) return false;
    if (b->setup->method) return true; /* plain C is the mean filter */
    double unused;
    if (!time_plain(b, &unused, err)) return false;
    const sv_result result = stage_result(&b->stage);
    if (result.depth) memcpy(b->depth, result.depth, rays * sizeof *b->depth);
    if (result.depth_object &&
        !hs_cl_check(clEnqueueReadBuffer(b->setup->cl->queue, result.depth_object, CL_TRUE,
                                         result.depth_offset, rays * sizeof *b->depth, b->depth, 0, NULL,
                                         NULL),
                     "clEnqueueReadBuffer (benchmark)", err))
        return false;
    *difference = 0.0;
    for (size_t i = 0; i < rays; i++) {
        const double off = fabs((double)b->depth[i] - b->plain_depth[i]);
        if (result.status[i] != b->plain_status[i] || !(off <= tolerance))
            return hs_fail(err, HS_ERR_FAILED,
                           "%u^3, %s: ray (%zu, %zu): the plugin gives depth %g, status %u; plain C %g, %u",
                           b->variant->n, routes[b->variant->route].label, i % b->variant->n,
                           i / b->variant->n, b->depth[i], result.status[i], b->plain_depth[i],
                           b->plain_status[i]);
        if (off > *difference) *difference = off;
    }
    return true;
}

/* In turns, so that whatever else the machine does hits all alike. */
static bool time_frames(bench *b, hs_progress *progress, hs_error *err) {
    for (uint32_t i = 0; i < WARM_UP + b->setup->frames; i++) {
        double ms[BENCH_PARTS] = {0};
        if (!b->setup->method && !time_plain(b, &ms[BENCH_PLAIN], err)) return false;
        if (!plugin_dropped(b, &ms[BENCH_DROPPED], err)) return false;
        if (!plugin_frame(b, false, ms, err)) return false;
        if (b->q_id && !plugin_adjust(b, &ms[BENCH_ADJUST], err)) return false;
        for (int p = 0; i >= WARM_UP && p < BENCH_PARTS; p++) bench_samples_add(&b->samples[p], ms[p]);
        if (i >= WARM_UP) hs_progress_step(progress, i + 1 - WARM_UP);
    }
    return true;
}

/* Stage times of a few more frames, apart from the others because events cost time. */
static bool time_stages(bench *b, bench_plugin_result *result, hs_error *err) {
    const sv_ext_timing *ext = hs_plugin_timing(b->instance);
    if (!ext || ext->enable(b->instance, 1) != SV_OK) return true;
    bench_samples samples[5] = {{0}};
    bool ok = true;
    for (int s = 0; s < 5; s++) ok = ok && bench_samples_create(&samples[s], STAGE_FRAMES, err);
    result->has_stages = ok;
    for (uint32_t i = 0; ok && i < STAGE_FRAMES; i++) {
        sv_stage_times t = {.size = sizeof t};
        ok = plugin_frame(b, false, NULL, err);
        if (!ok || ext->stage_times(b->instance, &t) != SV_OK) {
            result->has_stages = false;
            break;
        }
        const double ms[5] = {t.transfer_ms, t.profile_ms, t.threshold_ms, t.reconstruct_ms, t.output_ms};
        for (int s = 0; s < 5; s++) bench_samples_add(&samples[s], ms[s]);
    }
    double median[5];
    for (int s = 0; s < 5; s++) {
        median[s] = bench_samples_times(&samples[s]).median;
        bench_samples_destroy(&samples[s]);
    }
    result->stages =
        (sv_stage_times){sizeof(sv_stage_times), 0, median[0], median[1], median[2], median[3], median[4]};
    (void)ext->enable(b->instance, 0);
    return ok;
}

static void release(bench *b) {
    if (b->active) b->instance->deactivate(b->instance);
    plain_frame_destroy(b->plain);
    for (int p = 0; p < BENCH_PARTS; p++) bench_samples_destroy(&b->samples[p]);
    stage_free(&b->stage);
    free(b->volume.slice);
    free(b->depth);
    free(b->plain_depth);
    free(b->plain_status);
}

bool bench_plugin_run(const bench_plugin_setup *setup, const uint8_t *voxels, const bench_variant *variant,
                      hs_progress *progress, bench_plugin_result *result, hs_error *err) {
    static bench b; /* too large for the stack */
    b = (bench){.setup = setup,
                .variant = variant,
                .instance = setup->plugin->instance,
                .host_queue = routes[variant->route].host_queue};
    *result = (bench_plugin_result){
        .variant = *variant, .method = setup->method ? setup->method : PLAIN_METHOD, .frames = setup->frames};
    if (!make_values(&b, err)) return false;
    make_stage(&b, voxels);
    const bool ok = make_memory(&b, err) && activate(&b, err) && verify(&b, &result->difference, err) &&
                    time_frames(&b, progress, err) && time_stages(&b, result, err);
    for (int p = 0; ok && p < BENCH_PARTS; p++) result->times[p] = bench_samples_times(&b.samples[p]);
    result->stats = *stage_result(&b.stage).stats;
    result->points = b.points;
    release(&b);
    return ok;
}
