/* SPDX-License-Identifier: MIT */
#include "bench/methods.h"

#include "base/progress.h"
#include "bench/plain.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"
#include "ref/ref_chain.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* -------------------------------------------------------------------------------------------- variants -- */

const char *methods_variant_precision(const methods_variant *v) {
    return v->precision ? v->precision : "float64";
}

uint32_t methods_variant_reduction(const methods_variant *v) {
    return v->reduction ? v->reduction : 1;
}

bool methods_variant_approximates(const methods_variant *v) {
    return v->precision || v->spline_grid > 0 || v->reduction > 1;
}

methods_variant methods_variants[METHODS_VARIANTS] = {
    {.label = "mean k 3", .method = SV_METHOD_MEAN, .k = 3},
    {.label = "mean k 11", .method = SV_METHOD_MEAN, .k = 11, .quick = true},
    {.label = "mean k 23", .method = SV_METHOD_MEAN, .k = 23, .quick = true},
    {.label = "mean k 55", .method = SV_METHOD_MEAN, .k = 55, .quick = true},
    {.label = "mean k 3, int16", .method = SV_METHOD_MEAN, .k = 3, .precision = "int16"},
    {.label = "mean k 23, int16", .method = SV_METHOD_MEAN, .k = 23, .precision = "int16", .quick = true},
    {.label = "mean k 55, int16", .method = SV_METHOD_MEAN, .k = 55, .precision = "int16"},
    {.label = "mean k 23, 1/2", .method = SV_METHOD_MEAN, .k = 23, .reduction = 2, .quick = true},
    {.label = "mean k 23, 1/4", .method = SV_METHOD_MEAN, .k = 23, .reduction = 4},
    {.label = "minimum k 11", .method = SV_METHOD_MINIMUM, .k = 11},
    {.label = "minimum k 23", .method = SV_METHOD_MINIMUM, .k = 23, .quick = true},
    {.label = "minimum k 23, 1/2", .method = SV_METHOD_MINIMUM, .k = 23, .reduction = 2},
    {.label = "spline m 8, pixels", .method = SV_METHOD_SPLINE, .merge_grid = 8, .quick = true},
    {.label = "spline m 8, grid 8", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 8},
    {.label = "spline m 8, grid 16", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 16},
    {.label = "spline m 8, grid 32",
     .method = SV_METHOD_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .quick = true},
    {.label = "spline m 8, grid 64", .method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = 64},
    {.label = "spline m 8, g 32, f32",
     .method = SV_METHOD_SPLINE,
     .merge_grid = 8,
     .spline_grid = 32,
     .precision = "float32",
     .quick = true},
    {.label = "spline m 37, grid 32", .method = SV_METHOD_SPLINE, .merge_grid = 37, .spline_grid = 32},
    {.label = "spline unmerged, grid 32", .method = SV_METHOD_SPLINE, .spline_grid = 32},
    {.label = "spline m 8, pixels, 1/2", .method = SV_METHOD_SPLINE, .merge_grid = 8, .reduction = 2},
    {.label = "spline m 8, pixels, 1/4", .method = SV_METHOD_SPLINE, .merge_grid = 8, .reduction = 4},
};

void methods_variants_complete(void) {
    uint32_t used = 0;
    bool listed[SV_METHOD_END] = {false};
    for (; methods_variants[used].label; used++) listed[methods_variants[used].method] = true;
    for (uint32_t m = 0; m < SV_METHOD_END; m++)
        if (methods_on_points(m) && !listed[m])
            methods_variants[used++] =
                (methods_variant){.label = sv_ref_method_name(m), .method = m, .k = 23, .quick = true};
}

bool methods_on_points(uint32_t method) {
    const sv_ref_method *definition = sv_ref_method_of(method);
    return definition && !definition->takes_volume;
}

static bool add(const hs_plugin *plugin, const char *key, const char *value, methods_values *values,
                hs_error *err) {
    char text[64];
    sv_param_info info = {.size = sizeof info};
    sv_param_value *out = &values->all[values->count];
    (void)snprintf(text, sizeof text, "%s=%s", key, value);
    if (!hs_plugin_parse_param(plugin, text, out, err)) return false;
    if (hs_plugin_find_param(plugin, key, &info) && (info.flags & SV_PARAM_REACTIVATE))
        values->fixed[values->fixed_count++] = *out;
    values->count++;
    return true;
}

static bool add_number(const hs_plugin *plugin, const char *key, uint32_t value, methods_values *values,
                       hs_error *err) {
    char text[16];
    (void)snprintf(text, sizeof text, "%u", value);
    return add(plugin, key, text, values, err);
}

bool methods_values_make(const hs_plugin *plugin, const methods_variant *v, methods_values *values,
                         hs_error *err) {
    *values = (methods_values){0};
    return add(plugin, "method", sv_ref_method_name(v->method), values, err) &&
           (v->k == 0 || add_number(plugin, "kernel", v->k, values, err)) &&
           (v->method != SV_METHOD_SPLINE ||
            (add_number(plugin, "merge_grid", v->merge_grid, values, err) &&
             add_number(plugin, "spline_grid", v->spline_grid, values, err))) &&
           add_number(plugin, "reduction", methods_variant_reduction(v), values, err) &&
           add(plugin, "precision", methods_variant_precision(v), values, err);
}

/* ----------------------------------------------------------------------------------------------- times -- */

enum { WARM_UP = 2, MIN_FRAMES = 3, PLAIN_K = 23 };
static const double slow_ms = 100.0; /* a frame that needs no warm-up but the first */

typedef enum { END, RECONSTRUCT, MEMORY, PLAIN, PARTS } part;

/* One variant under way. Zeroed: nothing to free. */
typedef struct {
    const methods_setup *setup;
    const methods_map *map;
    const methods_variant *variant;
    const sv_plugin *instance;
    const sv_ext_timing *stats; /* NULL: the plugin has none */
    methods_values values;
    bool active;
    double first_ms; /* `end` of the first frame */
    plain_surface *plain;
    float *depth, *plain_depth; /* the plugin's map is the caller's */
    uint8_t *status;
    bench_samples samples[PARTS];
} timing;

static bool prepare(timing *t, hs_error *err) {
    const methods_map *m = t->map;
    const size_t rays = (size_t)m->n * m->n;
    const plain_points points = {m->n, m->n, METHODS_SLICES, m->status, m->near_end, m->far_end};
    t->plain_depth = malloc(rays * sizeof *t->plain_depth);
    t->status = malloc(rays);
    if (!t->plain_depth || !t->status)
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", t->variant->label, rays);
    for (int p = 0; p < PARTS; p++)
        if (!bench_samples_create(&t->samples[p], t->setup->frames, err)) return false;
    const uint32_t k = t->variant->method == SV_METHOD_MEAN ? t->variant->k : PLAIN_K;
    t->plain = plain_surface_create(t->setup->team, &points, k, err);
    return t->plain && methods_values_make(t->setup->plugin, t->variant, &t->values, err);
}

static bool activate(timing *t, hs_error *err) {
    const methods_map *m = t->map;
    const sv_format format = {.size = sizeof format,
                              .width = m->n,
                              .height = m->n,
                              .slices = METHODS_SLICES,
                              .max_slab_slices = METHODS_SLICES,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = m->n,
                              .tile_h = m->n,
                              .row_pitch = m->n,
                              .host_memory = m->voxels,
                              .host_memory_bytes = m->bytes,
                              .values = t->values.fixed,
                              .value_count = t->values.fixed_count};
    t->active =
        hs_plugin_check(t->setup->plugin, t->instance->activate(t->instance, &format), "activate", err);
    return t->active;
}

/* One frame with the plugin's own queue: everything is there when `end` returns. ms may be NULL. */
static bool frame(const timing *t, const sv_result *result, double *ms, hs_error *err) {
    const hs_plugin *p = t->setup->plugin;
    sv_param_value values[METHODS_MAX_VALUES + 1];
    sv_param_info q = {.size = sizeof q};
    if (!hs_plugin_find_param(p, "q", &q))
        return hs_fail(err, HS_ERR_PLUGIN, "%s: has no parameter 'q'", p->path);
    memcpy(values, t->values.all, sizeof t->values.all);
    values[t->values.count] = (sv_param_value){.id = q.id, .value = (double)t->setup->q};
    const sv_frame settings = {.size = sizeof settings, .values = values, .value_count = t->values.count + 1};
    const sv_slab slab = {.size = sizeof slab,
                          .slice_count = METHODS_SLICES,
                          .memory = t->map->voxels,
                          .bytes = (uint64_t)t->map->n * t->map->n * METHODS_SLICES};
    if (!hs_plugin_check(p, t->instance->begin(t->instance, &settings), "begin", err) ||
        !hs_plugin_check(p, t->instance->slab(t->instance, &slab), "slab", err))
        return false;
    const double start = hs_now();
    const bool ok = hs_plugin_check(p, t->instance->end(t->instance, result), "end", err);
    if (ms) *ms = (hs_now() - start) * 1e3;
    return ok;
}

/* The plugin must see the definition's points, and make a surface of them. */
static bool verify(timing *t, methods_times *times, hs_error *err) {
    const size_t rays = (size_t)t->map->n * t->map->n;
    sv_stats stats = {.size = sizeof stats};
    const sv_result result = {.size = sizeof result, .depth = t->depth, .status = t->status, .stats = &stats};
    if (!frame(t, &result, &t->first_ms, err)) return false;
    if (stats.outcome != SV_OK)
        return hs_fail(err, HS_ERR_FAILED, "%s, %u x %u: no surface (%s)", t->variant->label, t->map->n,
                       t->map->n, hs_status_name(stats.outcome));
    for (size_t i = 0; i < rays; i++)
        if (t->status[i] != t->map->status[i])
            return hs_fail(err, HS_ERR_FAILED, "%s: ray (%zu, %zu): the plugin's status is %u, expected %u",
                           t->variant->label, i % t->map->n, i / t->map->n, t->status[i], t->map->status[i]);
    sv_points_report points;
    hs_plugin_points(t->instance, &points);
    times->passes = points.passes;
    const sv_ext_spline *spline = hs_plugin_spline(t->instance);
    sv_spline_report report = {.size = sizeof report};
    if (t->variant->method == SV_METHOD_SPLINE && spline && spline->report(t->instance, &report) == SV_OK)
        times->control_points = report.points;
    return true;
}

/* A frame with events on: the stage's own time; negative if the plugin cannot tell. */
static bool stage_frame(const timing *t, const sv_result *result, double *ms, hs_error *err) {
    sv_stage_times stages = {.size = sizeof stages};
    *ms = -1.0;
    if (!t->stats || t->stats->enable(t->instance, 1) != SV_OK) return true;
    const bool ok = frame(t, result, NULL, err);
    if (ok && t->stats->stage_times(t->instance, &stages) == SV_OK) *ms = stages.reconstruct_ms;
    (void)t->stats->enable(t->instance, 0);
    return ok;
}

/* The threads are awake before the clock starts, and asleep again after. */
static double plain_ms(const timing *t, void (*work)(const timing *t)) {
    bench_team_ready(t->setup->team);
    const double start = hs_now();
    work(t);
    const double ms = (hs_now() - start) * 1e3;
    bench_team_rest(t->setup->team);
    return ms;
}
static void run_plain(const timing *t) {
    (void)plain_surface_run(t->plain, t->setup->q, t->plain_depth);
}
static void touch_memory(const timing *t) {
    plain_surface_touch(t->plain, t->setup->q, t->plain_depth);
}

/* In turns, so that whatever else the machine does hits all alike. */
static bool time_frames(timing *t, methods_times *times, hs_error *err) {
    const double start = hs_now();
    const uint32_t warm_up = t->first_ms > slow_ms ? 0 : WARM_UP;
    sv_stats stats = {.size = sizeof stats};
    const sv_result result = {.size = sizeof result, .depth = t->depth, .stats = &stats};
    const bool mean = t->variant->method == SV_METHOD_MEAN;
    (void)plain_ms(t, run_plain); /* its maps hold surfaces from now on */
    for (uint32_t i = 0; i < warm_up + t->setup->frames; i++) {
        if (times->frames >= MIN_FRAMES && hs_now() - start > t->setup->seconds) break;
        double ms[PARTS];
        ms[PLAIN] = mean ? plain_ms(t, run_plain) : -1.0;
        (void)plain_ms(
            t, touch_memory); /* the next finds the maps where this leaves them, in the cache or not */
        ms[MEMORY] = plain_ms(t, touch_memory);
        if (!frame(t, &result, &ms[END], err) || !stage_frame(t, &result, &ms[RECONSTRUCT], err))
            return false;
        if (i < warm_up) continue;
        times->frames++;
        for (int p = 0; p < PARTS; p++)
            if (ms[p] >= 0.0) bench_samples_add(&t->samples[p], ms[p]);
    }
    return true;
}

static void release(timing *t) {
    if (t->active) t->instance->deactivate(t->instance);
    plain_surface_destroy(t->plain);
    for (int p = 0; p < PARTS; p++) bench_samples_destroy(&t->samples[p]);
    free(t->plain_depth);
    free(t->status);
}

bool methods_time(const methods_setup *setup, const methods_map *map, const methods_variant *variant,
                  float *depth, methods_times *times, hs_error *err) {
    const sv_plugin *instance = setup->plugin->instance;
    timing t = {.setup = setup,
                .map = map,
                .variant = variant,
                .instance = instance,
                .stats = hs_plugin_timing(instance)};
    t.depth = depth;
    *times = (methods_times){0};
    const bool ok =
        prepare(&t, err) && activate(&t, err) && verify(&t, times, err) && time_frames(&t, times, err);
    if (ok) {
        times->end = bench_samples_times(&t.samples[END]);
        times->reconstruct = bench_samples_times(&t.samples[RECONSTRUCT]);
        times->memory = bench_samples_times(&t.samples[MEMORY]);
        times->plain = bench_samples_times(&t.samples[PLAIN]);
    }
    release(&t);
    return ok;
}
