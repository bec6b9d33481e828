/* SPDX-License-Identifier: MIT */
#include "commands/run.h"

#include "core/progress.h"
#include "core/system.h"
#include "guard/child.h"
#include "loop/view.h"
#include "plugin/loader_param.h"
#include "render/camera.h"
#include "show/loop_pictures.h"
#include "volume/metaimage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void hs_run_defaults(hs_run_request *request) {
    *request = (hs_run_request){.log_level = SV_LOG_WARNING, .scene = {.size = 256, .volumes = 1}};
    hs_loop_defaults(&request->loop);
    hs_guard_defaults(&request->guard);
    hs_loop_for_pictures(&request->loop, HS_LOOK_LIT);
    for (int s = 0; s < HS_SETTING_COUNT; s++) request->settings[s] = true;
}

/* What was made elsewhere instead of a plugin. */
static bool open_map(hs_run *run, const char *path, hs_error *err) {
    const uint32_t n = run->request.loop.lowres;
    run->depths = hs_metaimage_load_map(path, n, n, err);
    run->given = (hs_given_map){.mm = run->depths, .width = n, .height = n};
    (void)snprintf(run->plugin_path, sizeof run->plugin_path, "%s", path);
    run->has_plugin = run->depths && hs_plugin_open_map(&run->plugin, &run->given, err);
    return run->has_plugin;
}

/* Loads the plugin; if that fails, the run goes on without. Wrong parameters are the user's and stop it. */
static bool open_plugin(hs_run *run, hs_error *err) {
    const hs_run_request *r = &run->request;
    if (r->map) return open_map(run, r->map, err);
    if (r->plugin_path)
        (void)snprintf(run->plugin_path, sizeof run->plugin_path, "%s", r->plugin_path);
    else
        hs_plugin_default_path(run->plugin_path, sizeof run->plugin_path);
    run->has_plugin = hs_guarded_open(&run->plugin, run->plugin_path, r->plugin_id, r->log_level, &r->guard,
                                      &run->earlier_error);
    if (!run->has_plugin) return true;
    run->values = hs_memory(r->set_count + 1u, sizeof *run->values, "plugin parameters", err);
    if (!run->values) return false;
    for (uint32_t i = 0; i < r->set_count; i++)
        if (!hs_plugin_parse_param(&run->plugin, r->sets[i], &run->values[i], err)) return false;
    run->request.loop.values = run->values;
    run->request.loop.value_count = r->set_count;
    return true;
}

/* A child that compiles needs no more of a scene: from 64 rays on a row fills the widest vectors, and a
 * kernel is the same for volumes of all sizes, up to those that need more than 16 MB. */
enum { SIZE_TO_COMPILE = 64 };

static bool open_volumes(hs_run *run, hs_error *err) {
    const hs_run_request *r = &run->request;
    hs_source_scene scene = r->scene;
    if (hs_child_is_one() && scene.size > SIZE_TO_COMPILE) scene.size = SIZE_TO_COMPILE;
    if (scene.name) return hs_source_open_scene(&run->source, &scene, err);
    return hs_source_open_files(&run->source, r->volumes, r->volume_count, &r->files, err);
}

static bool open_source(hs_run *run, hs_error *err) {
    const bool open = open_volumes(run, err) && hs_source_crop(&run->source, &run->request.crop, err);
    const hs_volume *first = open ? hs_source_bring(&run->source, 0, err) : NULL;
    if (first) run->unscanned = hs_unscanned_share(first);
    return first != NULL;
}

/* PoCL compiles one kernel at a time in a process, whatever its threads. So where it has compiled nothing
 * yet, two processes do it side by side, and find each other's work in its cache. */
#define COLD_S    0.4   /* building the host's program takes longer: the driver does not have it */
#define LONGEST_S 120.0 /* then the plugin's kernels are compiled here */

static bool create_loop(hs_run *run, hs_error *err) {
    run->loop = hs_loop_create(&run->cl, &run->source, run->has_plugin ? &run->plugin : NULL,
                               &run->request.loop, err);
    return run->loop != NULL;
}

enum { SIDE_TO_COMPILE = 32 }; /* of a picture that nobody sees */

/* The parent's side: a small frame without the plugin, and where its rays end, which the pictures ask for.
 * The child's side is to open the same and leave. */
static bool compile_host(hs_run *run, hs_error *err) {
    hs_loop_options options = run->request.loop;
    hs_frame frame;
    options.dvr.width = options.dvr.height = SIDE_TO_COMPILE;
    float *ends = calloc((size_t)options.dvr.width * options.dvr.height + 1u, sizeof *ends);
    hs_loop *loop = hs_loop_create(&run->cl, &run->source, NULL, &options, err);
    const bool ok = ends && loop && hs_loop_frame(loop, HS_SETTING_SMARTVIS, 0, &frame, err) &&
                    hs_loop_ray_ends(loop, 0, NULL, ends, err);
    hs_loop_destroy(loop);
    free(ends);
    return ok || err->code != HS_OK || hs_fail(err, HS_ERR_MEMORY, "ends of rays: no memory");
}

/* True for the host's own plugin alone: another one has a process of its own anyway, or might disturb itself
 * by what it writes, as the layer its recording. */
static bool can_share(const hs_run *run) {
    const hs_guard_options as_usual = {.choice = HS_GUARD_AUTO};
    return run->request.alone && run->has_plugin && !hs_is_guarded(&run->plugin) &&
           !hs_guard_wanted(&as_usual, run->plugin.path);
}

static bool open_loop(hs_run *run, hs_error *err) {
    const hs_child_limits mute = {.output = HS_CHILD_DISCARDED};
    hs_child child = {0};
    hs_error ignored = {0}; /* without a child it only takes longer */
    const double begin = hs_now();
    bool ok = hs_cl_open(&run->cl, err);
    if (ok && can_share(run) && !hs_child_is_one() && hs_now() - begin > COLD_S &&
        hs_child_again(&child, &mute, NULL, 0, &ignored)) {
        ok = compile_host(run, err);
        hs_child_wait_end(&child, LONGEST_S);
    }
    hs_child_close(&child);
    ok = ok && create_loop(run, err);
    if (hs_child_is_one()) hs_child_leave(ok ? HS_OK : HS_ERR_DEVICE); /* its kernels are compiled */
    return ok;
}

/* Optimising takes as long as this many pixels take without. */
#define FEW_PIXELS (8.0 * 512 * 512)

/* Asks for kernels that are there soon (smartvis/author_programs.h), unless the user has said otherwise. */
static void hurry_if_little(const hs_run_request *r) {
    const hs_dvr_settings *picture = &r->loop.dvr;
    const bool one_volume = r->volume_count <= 1 && r->scene.volumes <= 1;
    int settings = 0;
    for (int s = 0; s < HS_SETTING_COUNT; s++) settings += r->settings[s];
    const double pixels = (double)picture->width * picture->height * settings * (r->loop.frames + 1.0);
    if (r->alone && one_volume && !r->loop.live && pixels <= FEW_PIXELS)
        sys_set_default("SMARTVIS_QUICK_KERNELS", "1");
}

bool hs_run_open(hs_run *run, const hs_run_request *request, hs_error *err) {
    *run = (hs_run){.request = *request};
    hurry_if_little(request);
    if (open_plugin(run, err) && open_source(run, err) && open_loop(run, err)) return true;
    hs_error ignored = {0}; /* the first failure is told */
    (void)hs_run_close(run, &ignored);
    return false;
}

bool hs_run_replace_loop(hs_run *run, const hs_loop_options *options, hs_error *err) {
    run->earlier_error = *hs_run_plugin_error(run);
    run->earlier_confidence_error = *hs_run_confidence_error(run);
    hs_loop_destroy(run->loop);
    run->request.loop = *options;
    run->loop = hs_loop_create(&run->cl, &run->source, run->has_plugin ? &run->plugin : NULL, options, err);
    return run->loop != NULL;
}

bool hs_run_close(hs_run *run, hs_error *err) {
    hs_loop_destroy(run->loop);
    const bool ok = !run->has_plugin || hs_guarded_close(&run->plugin, err);
    hs_cl_close(&run->cl);
    hs_source_close(&run->source);
    free(run->values);
    free(run->depths);
    *run = (hs_run){0};
    return ok;
}

bool hs_run_has_stage(const hs_run *run, hs_setting setting, hs_stage stage) {
    if (stage == HS_STAGE_UPLOAD) return run->source.count > 1 || run->request.loop.live;
    if (stage == HS_STAGE_CONVERT) return setting != HS_SETTING_DVR;
    return stage != HS_STAGE_PLUGIN || setting == HS_SETTING_SMARTVIS;
}

bool hs_run_measure(hs_run *run, hs_error *err) {
    bool ok = true;
    run->result_count = 0;
    for (int s = 0; ok && s < HS_SETTING_COUNT; s++) {
        if (!run->request.settings[s]) continue;
        hs_progress progress;
        hs_progress_begin(&progress, hs_setting_label((hs_setting)s), run->request.loop.frames);
        ok = hs_loop_run(run->loop, (hs_setting)s, &progress, &run->results[run->result_count], err);
        hs_progress_end(&progress);
        if (ok) run->result_count++;
    }
    return ok;
}

const hs_error *hs_run_plugin_error(const hs_run *run) {
    return run->earlier_error.code != HS_OK || !run->loop ? &run->earlier_error
                                                          : hs_loop_plugin_error(run->loop);
}

const hs_error *hs_run_confidence_error(const hs_run *run) {
    return run->earlier_confidence_error.code != HS_OK || !run->loop ? &run->earlier_confidence_error
                                                                     : hs_loop_confidence_error(run->loop);
}

void hs_run_plugin_name(const hs_run *run, char *out, size_t bytes) {
    if (!run->has_plugin) {
        (void)snprintf(out, bytes, "no plugin");
        return;
    }
    if (run->request.map) {
        const char *const slash = strrchr(run->request.map, '/');
        (void)snprintf(out, bytes, "%s", slash ? slash + 1 : run->request.map);
        return;
    }
    const sv_descriptor *d = run->plugin.instance->descriptor;
    (void)snprintf(out, bytes, "%s %s", d->id, d->version);
}

/* With the mark of orientation, where the source has one. */
static void picture_title(const hs_run *run, char *out, size_t bytes) {
    char plugin[200], name[340];
    hs_camera camera;
    const hs_volume *shape = hs_source_shape(&run->source);
    hs_loop_camera(run->loop, run->request.loop.frames / 2, &camera);
    hs_camera_title(shape->name, &camera, shape, name, sizeof name);
    hs_run_plugin_name(run, plugin, sizeof plugin);
    (void)snprintf(out, bytes, "%s, %s", name, plugin);
}

/* Somebody may be waiting for the result, so it is written before the other pictures are drawn. */
bool hs_run_pictures(hs_run *run, const char *folder, hs_error *err) {
    char title[600], note[1100];
    hs_view view;
    picture_title(run, title, sizeof title);
    const uint32_t middle = run->request.loop.frames / 2;
    if (!hs_loop_view_result(run->loop, middle, &view, err)) return false;
    const bool ok = hs_loop_write_result(&view, folder, err) &&
                    hs_loop_view_rest(run->loop, middle, &view, err) &&
                    hs_loop_write_full(&view, folder, err) &&
                    (run->request.few_pictures ||
                     hs_loop_write_rest(
                         &view, folder, title,
                         hs_frame_note(&view.maps.frame, hs_run_plugin_error(run)->text, note, sizeof note),
                         run->request.panel_cell, err));
    hs_view_free(&view);
    return ok;
}

bool hs_run_write(hs_run *run, const char *folder, hs_error *err) {
    const hs_run_request *r = &run->request;
    const uint32_t wanted = r->write | (r->reference ? HS_RESULT_DEPTHMAP : 0u);
    const hs_slab_layout *l = hs_loop_layout(run->loop);
    if (!(wanted | r->write_if)) return true;
    if (r->reference && run->source.count > 1)
        return hs_fail(err, HS_ERR_USAGE, "--reference %s: is one map, and the source has %u volumes",
                       r->reference, run->source.count);
    run->has_written =
        hs_results_write(run->loop, &run->source, wanted, r->write_if, folder, &run->written, err);
    return run->has_written && (!r->reference || hs_result_compare(folder, r->reference, l->width, l->height,
                                                                   r->tolerance, &run->difference, err));
}

double hs_unscanned_share(const hs_volume *volume) {
    const size_t count = hs_volume_count(volume);
    size_t zeros = 0;
    for (size_t i = 0; i < count; i++) zeros += volume->voxels[i] == 0;
    return count ? (double)zeros / (double)count : 0;
}
