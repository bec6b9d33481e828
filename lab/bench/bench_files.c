/* SPDX-License-Identifier: MIT */
/* The benchmark's results as CSV and JSON. */
#include "bench/bench_results.h"

#include "base/output_file.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const part_keys[BENCH_PARTS] = {"read",  "plain_c", "frame",  "begin",
                                                   "slabs", "end",     "adjust", "dropped"};
static const struct {
    const char *key;
    hs_stage stage;
} loop_stages[] = {{"upload", HS_STAGE_UPLOAD},
                   {"convert", HS_STAGE_CONVERT},
                   {"plugin", HS_STAGE_PLUGIN},
                   {"dvr", HS_STAGE_DVR},
                   {"loop", HS_STAGE_LOOP}};
enum { LOOP_STAGES = sizeof loop_stages / sizeof *loop_stages, VIEWS = 3 };

static void list_views(const bench_host_result *host, const char *keys[VIEWS],
                       const bench_view_result *views[VIEWS]) {
    static const char *const names[VIEWS] = {"still", "rotated", "live"};
    memcpy(keys, names, sizeof names);
    views[0] = &host->still;
    views[1] = &host->rotated;
    views[2] = &host->live;
}

static void csv_host(FILE *file, const bench_host_result *host) {
    const char *keys[VIEWS];
    const bench_view_result *views[VIEWS];
    list_views(host, keys, views);
    for (int v = 0; v < VIEWS; v++)
        for (int s = 0; s < HS_SETTING_COUNT; s++)
            for (int i = 0; i < LOOP_STAGES; i++) {
                const hs_timing *t = &views[v]->settings[s].stage[loop_stages[i].stage];
                (void)fprintf(file, "loop,%u,,,%s-%s,%s,%.6g,,%.6g,,,,\n", host->size, keys[v],
                              hs_setting_key((hs_setting)s), loop_stages[i].key, t->median, t->p95);
            }
    (void)fprintf(file, "loop,%u,,,still,mip,%.6g,%.6g,%.6g,,,,\n", host->size, host->mip.median,
                  host->mip.min, host->mip.p95);
    (void)fprintf(file, "loop,%u,,,still,grid,%.6g,%.6g,%.6g,,,,\n", host->size, host->grid.median,
                  host->grid.min, host->grid.p95);
    for (int v = 0; v < BENCH_VIEWS; v++) {
        const bench_lit_view *l = &host->lit.view[v];
        const bench_times *const looks[2] = {&l->thesis, &l->lit};
        for (int i = 0; i < 2; i++)
            (void)fprintf(file, "look,%u,,,%s,%s,%.6g,%.6g,%.6g,,,,\n", host->size, l->label,
                          hs_look_key((hs_look)i), looks[i]->median, looks[i]->min, looks[i]->p95);
    }
}

static void csv_grids(FILE *file, const bench_grids_result *r) {
    static const char *const ways[4] = {"copy", "probe", "copy-walks", "probe-walks"};
    for (int i = 0; i < BENCH_VIEWS; i++) {
        const bench_grid_view *v = &r->view[i];
        const bench_times *const times[4] = {&v->copy, &v->probe, &v->copy_walks, &v->probe_walks};
        for (int w = 0; w < 4; w++)
            (void)fprintf(file, "grids,%u,,,%s,%s,%.6g,%.6g,%.6g,,,,\n", r->samples, v->label, ways[w],
                          times[w]->median, times[w]->min, times[w]->p95);
    }
    (void)fprintf(file, "grids,%u,,,,making,%.6g,%.6g,%.6g,,,,\n", r->samples, r->making.median,
                  r->making.min, r->making.p95);
}

/* A number, or nothing where it is not known. */
static void csv_number(FILE *file, double value) {
    if (isfinite(value))
        (void)fprintf(file, ",%.6g", value);
    else
        (void)fprintf(file, ",");
}

static void csv_start(FILE *file, const bench_plugin_result *r, const char *part) {
    const bool mean = strcmp(r->method, "mean") == 0;
    (void)fprintf(file, "%s,%u,%u,%u,%s,%s", mean ? "plugin" : r->method, r->variant.n, r->variant.k,
                  r->variant.slab_slices, bench_route_key(r->variant.route), part);
}

static void csv_plugin(FILE *file, const bench_report *report, const bench_plugin_result *r) {
    const bench_profile_ratio ratio = bench_per_profile(report, r);
    for (int p = 0; p < BENCH_PARTS; p++) {
        const bench_times *t = &r->times[p];
        const double plain = r->times[BENCH_PLAIN].median;
        if (p == BENCH_PLAIN && !(plain > 0.0)) continue;
        csv_start(file, r, part_keys[p]);
        (void)fprintf(file, ",%.6g,%.6g,%.6g,%.6g", t->median, t->min, t->p95,
                      t->median / r->times[BENCH_READ].median);
        csv_number(file, plain > 0.0 ? t->median / plain : NAN);
        csv_number(file, p == BENCH_FRAME ? ratio.mean : NAN);
        csv_number(file, p == BENCH_FRAME ? ratio.own : NAN);
        (void)fprintf(file, "\n");
    }
    if (!r->has_stages) return;
    const struct {
        const char *key;
        double ms;
    } stages[] = {{"stage_transfer", r->stages.transfer_ms},
                  {"stage_profile", r->stages.profile_ms},
                  {"stage_threshold", r->stages.threshold_ms},
                  {"stage_reconstruct", r->stages.reconstruct_ms},
                  {"stage_output", r->stages.output_ms}};
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        csv_start(file, r, stages[i].key);
        (void)fprintf(file, ",%.6g,,,,,,\n", stages[i].ms);
    }
}

bool bench_write_csv(const bench_report *report, const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (!hs_output_open(&output, path, err)) return false;
    (void)fprintf(output.file, "section,size,k,slab,route,part,median_ms,min_ms,p95_ms,per_read,per_plain_c,"
                               "per_mean_profile,per_own_profile\n");
    for (uint32_t i = 0; i < report->plugin_count; i++) csv_plugin(output.file, report, &report->plugin[i]);
    if (report->host) csv_host(output.file, report->host);
    if (report->grids) csv_grids(output.file, report->grids);
    return hs_output_commit(&output, err); /* fails if any write before did */
}

static json_t *json_times(bench_times t) {
    return json_pack("{s:f,s:f,s:f}", "median", t.median, "min", t.min, "p95", t.p95);
}

/* JSON has no NaN. */
static json_t *json_known(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *json_plugin(const bench_report *report, const bench_plugin_result *r) {
    const bench_profile_ratio ratio = bench_per_profile(report, r);
    const double plain = r->times[BENCH_PLAIN].median;
    json_t *parts = json_object();
    for (int p = 0; p < BENCH_PARTS; p++)
        (void)json_object_set_new(parts, part_keys[p], json_times(r->times[p]));
    json_t *object =
        json_pack("{s:s,s:i,s:i,s:i,s:s,s:i,s:o,s:f,s:o,s:o,s:o,s:f,s:i,s:i,s:i}", "method", r->method,
                  "size", (int)r->variant.n, "k", (int)r->variant.k, "slab", (int)r->variant.slab_slices,
                  "route", bench_route_key(r->variant.route), "frames", (int)r->frames, "ms", parts,
                  "per_read", r->times[BENCH_FRAME].median / r->times[BENCH_READ].median, "per_plain_c",
                  json_known(plain > 0.0 ? r->times[BENCH_FRAME].median / plain : NAN), "per_mean_profile",
                  json_known(ratio.mean), "per_own_profile", json_known(ratio.own),
                  "largest_difference_slices", r->difference, "points", (int)r->stats.points, "empty_points",
                  (int)r->points.empty_points, "passes", (int)r->points.passes);
    if (r->has_stages)
        (void)json_object_set_new(object, "stages_ms",
                                  json_pack("{s:f,s:f,s:f,s:f,s:f}", "transfer", r->stages.transfer_ms,
                                            "profile", r->stages.profile_ms, "threshold",
                                            r->stages.threshold_ms, "reconstruct", r->stages.reconstruct_ms,
                                            "output", r->stages.output_ms));
    return object;
}

static json_t *json_view(const bench_view_result *view) {
    json_t *object = json_object();
    for (int s = 0; s < HS_SETTING_COUNT; s++) {
        const hs_loop_result *r = &view->settings[s];
        json_t *ms = json_object();
        for (int i = 0; i < LOOP_STAGES; i++) {
            const hs_timing *t = &r->stage[loop_stages[i].stage];
            (void)json_object_set_new(ms, loop_stages[i].key,
                                      json_pack("{s:f,s:f}", "median", t->median, "p95", t->p95));
        }
        (void)json_object_set_new(object, hs_setting_key((hs_setting)s),
                                  json_pack("{s:o,s:f,s:f,s:i,s:i}", "ms", ms, "volumes_per_second",
                                            r->volumes_per_second, "plugin_share", r->plugin_share, "frames",
                                            (int)r->frames, "clipped_frames", (int)r->clipped_frames));
    }
    return object;
}

static json_t *json_host(const bench_host_result *host) {
    const char *keys[VIEWS];
    const bench_view_result *views[VIEWS];
    list_views(host, keys, views);
    json_t *object =
        json_pack("{s:i,s:i,s:s,s:o,s:o}", "size", (int)host->size, "lowres", (int)host->lowres, "volume",
                  host->volume, "mip_ms", json_times(host->mip), "grid_ms", json_times(host->grid));
    for (int v = 0; v < VIEWS; v++) (void)json_object_set_new(object, keys[v], json_view(views[v]));
    return object;
}

bool bench_write_json(const bench_report *report, const char *path, hs_error *err) {
    const bench_machine *m = &report->machine;
    json_t *plugin = json_array();
    for (uint32_t i = 0; i < report->plugin_count; i++)
        (void)json_array_append_new(plugin, json_plugin(report, &report->plugin[i]));
    json_t *root = json_pack("{s:{s:s,s:i,s:s,s:s,s:s,s:s,s:f},s:s,s:s,s:o}", "machine", "cpu", m->cpu,
                             "processors", (int)m->processors, "device", m->device, "device_version",
                             m->version, "driver", m->driver, "platform", m->platform, "load", m->load,
                             "compiler", __VERSION__, "plugin", m->plugin, "frames", plugin);
    if (report->host && root) (void)json_object_set_new(root, "loop", json_host(report->host));
    char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) : NULL;
    hs_output_file output = {0};
    bool ok = text || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for the JSON text", path);
    ok = ok && hs_output_open(&output, path, err);
    if (ok && hs_output_write(&output, text, strlen(text), err) && hs_output_write(&output, "\n", 1, err))
        ok = hs_output_commit(&output, err);
    else
        ok = false;
    hs_output_discard(&output);
    free(text);
    json_decref(root);
    return ok;
}
