/* SPDX-License-Identifier: MIT */
#include "eval/eval_case.h"

#include "core/progress.h"
#include "core/system.h"
#include "core/text.h"
#include "loop/loop_run.h"
#include "plugin/loader_param.h"
#include "volume/fan_fit.h"
#include "volume/kretz.h"
#include "volume/metaimage.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- volume -- */

/* The files of a case, in the order of its name. */
enum { FULL, TRUTH, LABEL, FIRST, END, REFERENCE, PARTS };

/* "FULL,TRUTH,LABEL[,FIRST,END][,REFERENCE]" in its parts: how many there are, 0 if it is no such text. */
static int split(const char *text, char part[PARTS][SYS_PATH]) {
    for (int i = 0; i < PARTS; i++) {
        const char *comma = strchr(text, ',');
        const size_t length = comma ? (size_t)(comma - text) : strlen(text);
        if (length == 0 || length >= SYS_PATH) return 0;
        memcpy(part[i], text, length);
        part[i][length] = '\0';
        if (!comma) {
            if (i == FIRST) memcpy(part[REFERENCE], part[FIRST], length + 1);
            return i >= LABEL ? i + 1 : 0;
        }
        text += length + 1;
    }
    return 0;
}

static bool check_truth(const hs_volume *full, const hs_volume *truth, const char *path, hs_error *err) {
    if (truth->nx != full->nx || truth->ny != full->ny || truth->nz != full->nz)
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u voxels, the volume has %u x %u x %u", path,
                       truth->nx, truth->ny, truth->nz, full->nx, full->ny, full->nz);
    for (int axis = 0; axis < 3; axis++)
        if (truth->spacing[axis] != full->spacing[axis])
            return hs_fail(err, HS_ERR_INPUT, "%s: spacing %g mm along axis %d, the volume has %g mm", path,
                           truth->spacing[axis], axis, full->spacing[axis]);
    return true;
}

static bool check_label(const hs_volume *full, const hs_volume *label, const char *path, hs_error *err) {
    if (label->nx != full->nx || label->ny != full->ny || label->nz != 1)
        return hs_fail(err, HS_ERR_INPUT, "%s: %u x %u x %u labels, expected %u x %u x 1", path, label->nx,
                       label->ny, label->nz, full->nx, full->ny);
    for (size_t i = 0; i < hs_volume_count(label); i++)
        if (label->voxels[i] > HS_LABEL_FETUS)
            return hs_fail(err, HS_ERR_INPUT, "%s: label %u, expected 0 (neither), 1 (sac) or 2 (fetus)",
                           path, label->voxels[i]);
    return true;
}

/* A label promises that something can be seen there, so the ray must have been scanned. */
static bool check_scanned(const hs_volume *full, const hs_volume *label, char part[PARTS][SYS_PATH],
                          hs_error *err) {
    const size_t rays = (size_t)full->nx * full->ny;
    double *maps = malloc(2 * rays * sizeof *maps);
    if (!maps) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a map of %zu rays", part[FIRST], rays);
    bool ok = hs_metaimage_read_map(part[FIRST], full->nx, full->ny, maps, err) &&
              hs_metaimage_read_map(part[END], full->nx, full->ny, maps + rays, err);
    for (size_t i = 0; ok && i < rays; i++) {
        const size_t x = i % full->nx, y = i / full->nx;
        const double first = maps[i], end = maps[rays + i];
        if (first > end)
            ok = hs_fail(err, HS_ERR_INPUT, "%s: pixel (%zu, %zu) is %g, behind %g in %s", part[FIRST], x, y,
                         first, end, part[END]);
        else if (first == end && label->voxels[i] != HS_LABEL_NEITHER)
            ok = hs_fail(err, HS_ERR_INPUT,
                         "%s: label %u at pixel (%zu, %zu), where nothing was scanned: %g .. %g in %s and %s",
                         part[LABEL], label->voxels[i], x, y, first, end, part[FIRST], part[END]);
    }
    free(maps);
    return ok;
}

/* The volume that the plugin gets; with maps, what they call unscanned is 0. */
static bool open_full(hs_eval_source *s, char part[PARTS][SYS_PATH], bool ranged,
                      const hs_metaimage_options *read, hs_error *err) {
    hs_source_files how = {.metaimage = *read};
    for (int k = 0; ranged && k < 2; k++) how.metaimage.scanned[k] = part[FIRST + k];
    const char *const path = part[FULL];
    if (!hs_source_open_files(&s->source, &path, 1, &how, err)) return false;
    return s->source.count == 1 ||
           hs_fail(err, HS_ERR_INPUT, "%s: a sequence of %u volumes, expected one", path, s->source.count);
}

static void note_doubts(const hs_volume *volume, char *out, size_t bytes) {
    char size[HS_DOUBT_BYTES] = "", question[160], beams[160];
    hs_course_question(volume, question, sizeof question);
    const bool doubted = hs_volume_doubt(volume, size) || hs_pose_doubt(&volume->pose, size);
    (void)snprintf(out, bytes, "%s%s%s", size, doubted && question[0] ? " " : "", question);
    if (out[0]) hs_print(stderr, "%s: %s\n", volume->name, out);
    hs_course_words(volume, beams, sizeof beams);
    if (volume->course.found || !hs_probe_is_known(volume))
        hs_print(stderr, "%s: beams: %s\n", volume->name, beams);
    const size_t used = strlen(out);
    if (!hs_probe_is_known(volume)) /* what is assumed stands on the page, too */
        (void)snprintf(out + used, bytes - used, "%sBeams: %s.", used ? " " : "", beams);
}

/* The truth, or what an expert left of the volume: in its place, and on its grid. */
static bool read_beside(hs_volume *out, const hs_volume *volume, const char *path, bool ranged,
                        const hs_metaimage_options *read, hs_error *err) {
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    if (!(ranged ? hs_metaimage_read(path, &as_it_is, out, err) : hs_volume_file_read(path, out, err)))
        return false;
    if (read->has_spacing) memcpy(out->spacing, read->spacing, sizeof read->spacing);
    return check_truth(volume, out, path, err);
}

static bool open_files(hs_eval_source *s, const hs_eval_request *request, hs_error *err) {
    /* Labels of 0 are labels: no zero is raised. */
    static const hs_metaimage_options as_it_is = {.padding = HS_PADDING_ALL};
    const char *const names = request->name;
    char part[PARTS][SYS_PATH];
    const int parts = split(names, part);
    if (parts == 0)
        return hs_fail(err, HS_ERR_USAGE,
                       "'%s': expected three to six files, FULL,TRUTH,LABEL[,FIRST,END][,REFERENCE]", names);
    const bool ranged = parts > END, compared = parts == FIRST + 1 || parts == REFERENCE + 1;
    if (!open_full(s, part, ranged, &request->read, err)) return false;
    const hs_volume *volume = hs_source_volume(&s->source, 0);
    if (!read_beside(&s->given_truth, volume, part[TRUTH], ranged, &request->read, err) ||
        (compared &&
         !read_beside(&s->given_reference, volume, part[REFERENCE], ranged, &request->read, err)) ||
        !hs_metaimage_read(part[LABEL], &as_it_is, &s->given_label, err) ||
        !check_label(volume, &s->given_label, part[LABEL], err))
        return false;
    if (ranged) {
        double *maps = check_scanned(volume, &s->given_label, part, err)
                           ? hs_scanned_maps_load(&s->given_truth, part[FIRST], part[END], err)
                           : NULL;
        if (!maps) return false;
        hs_scanned_maps_mark(&s->given_truth, maps);
        if (compared) hs_scanned_maps_mark(&s->given_reference, maps);
        free(maps);
    }
    s->label = s->given_label.voxels;
    note_doubts(volume, s->doubt, sizeof s->doubt);
    return hs_source_set_truth(&s->source, &s->given_truth, err);
}

static bool open_scene(hs_eval_source *s, const hs_eval_request *request, hs_error *err) {
    const hs_source_scene scene = {.name = request->name,
                                   .size = request->size,
                                   .seed = request->seed,
                                   .volumes = 1,
                                   .real = strcmp(request->name, "real") == 0 ? request->real : NULL};
    if (!hs_source_open_scene(&s->source, &scene, err)) return false;
    s->label = hs_source_scene_data(&s->source, 0)->label;
    return true;
}

bool hs_eval_source_open(hs_eval_source *source, const hs_eval_request *request, hs_error *err) {
    *source = (hs_eval_source){0};
    const bool files = strchr(request->name, ',') != NULL;
    if (files ? open_files(source, request, err) : open_scene(source, request, err)) return true;
    hs_eval_source_close(source);
    return false;
}

void hs_eval_source_close(hs_eval_source *source) {
    hs_source_close(&source->source);
    hs_volume_free(&source->given_truth);
    hs_volume_free(&source->given_reference);
    hs_volume_free(&source->given_label);
    *source = (hs_eval_source){0};
}

/* ------------------------------------------------------------------------------------------------ case -- */

#define MAX_REPEATS 15

bool hs_eval_values_add(hs_eval_values *values, uint32_t id, double value, hs_error *err) {
    for (uint32_t i = 0; i < values->count; i++)
        if (values->at[i].id == id) {
            values->at[i].value = value;
            return true;
        }
    if (values->count >= HS_EVAL_MAX_VALUES)
        return hs_fail(err, HS_ERR_USAGE, "more than %u parameter values", HS_EVAL_MAX_VALUES);
    values->at[values->count++] = (sv_param_value){.id = id, .value = value};
    return true;
}

bool hs_eval_values_parse(hs_eval_values *values, const hs_plugin *plugin, const char *const *sets,
                          uint32_t count, hs_error *err) {
    for (uint32_t i = 0; i < count; i++) {
        sv_param_value value;
        if (!hs_plugin_parse_param(plugin, sets[i], &value, err) ||
            !hs_eval_values_add(values, value.id, value.value, err))
            return false;
    }
    return true;
}

void hs_eval_knob_spread(hs_eval_knob *knob, const hs_plugin *plugin, uint32_t wanted) {
    *knob = (hs_eval_knob){.count = 1};
    knob->exists = hs_plugin_find_primary(plugin, &knob->info);
    if (!knob->exists) return;
    const double low = knob->info.display_min, high = knob->info.display_max, step = knob->info.step;
    const double allowed = step > 0 ? floor((high - low) / step + 1e-9) + 1 : wanted;
    knob->count = (uint32_t)fmin(fmax(fmin(wanted, allowed), 1), HS_EVAL_MAX_LINE);
    for (uint32_t i = 0; i < knob->count; i++) {
        const double at = knob->count > 1 ? low + (high - low) * i / (knob->count - 1) : low;
        /* On the grid of the parameter's own steps, as plain decimals: 0.15, not 0.15000000000000002. */
        knob->value[i] = step > 0 ? fmin(low + round((at - low) / step) * step, high) : at;
        knob->value[i] = round(knob->value[i] * 1e9) / 1e9;
    }
}

/* ---------------------------------------------------------------------------------------------- open -- */

/* A loop whose picture has a pixel for every ray of the map. */
static bool make_loop(hs_eval_case *c, const hs_cl *cl, const hs_eval_values *fixed, uint32_t lowres,
                      hs_error *err) {
    hs_loop_options options;
    hs_loop_defaults(&options);
    options.frames = 1;
    options.lowres = lowres;
    options.lowres = hs_loop_lowres(&c->from.source, &options);
    options.dvr.width = options.dvr.height = options.lowres;
    options.values = fixed->at;
    options.value_count = fixed->count;
    c->loop = hs_loop_create(cl, &c->from.source, c->plugin, &options, err);
    if (!c->loop) return false;
    const hs_error *failure = hs_loop_plugin_error(c->loop);
    return failure->code == HS_OK || hs_fail(err, failure->code, "%s", failure->text);
}

static bool allocate(hs_eval_case *c, hs_error *err) {
    const size_t pixels = (size_t)c->table.width * c->table.height;
    c->map = calloc(pixels, sizeof(float));
    c->termination = calloc(pixels, sizeof(float));
    return (c->map && c->termination) ||
           hs_fail(err, HS_ERR_MEMORY, "evaluation: no memory for %zu pixels", pixels);
}

/* The plugin on the slabs, which stay on the device; `map` may be NULL. */
static bool run_frame(hs_eval_case *c, const hs_eval_values *values, hs_frame *frame, float *map,
                      hs_error *err) {
    hs_loop_set_values(c->loop, values->at, values->count);
    const bool ok = hs_loop_clip(c->loop, (uint32_t)c->frame++, frame, map, err);
    hs_loop_set_values(c->loop, NULL, 0); /* the caller's list does not outlive the frame */
    return ok;
}

bool hs_eval_case_open(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin, const hs_eval_values *fixed,
                       const hs_eval_request *request, hs_error *err) {
    *c = (hs_eval_case){.plugin = plugin};
    hs_frame frame;
    bool ok = hs_eval_source_open(&c->from, request, err) && make_loop(c, cl, fixed, request->lowres, err) &&
              hs_eval_table_build(&c->table, c->loop, hs_source_volume(&c->from.source, 0),
                                  hs_source_truth(&c->from.source, 0), c->from.label, err) &&
              allocate(c, err) && hs_loop_convert(c->loop, 0, err) &&
              (!plugin || run_frame(c, fixed, &frame, NULL, err));
    if (ok)
        c->volume_max = plugin ? (double)frame.points.volume_max : 0.0;
    else
        hs_eval_case_close(c);
    return ok;
}

void hs_eval_case_release(hs_eval_case *c) {
    hs_loop_destroy(c->loop);
    c->loop = NULL;
}

bool hs_eval_case_replace(hs_eval_case *c, const hs_cl *cl, const hs_plugin *plugin,
                          const hs_eval_values *fixed, hs_error *err) {
    hs_eval_case_release(c);
    c->plugin = plugin;
    return make_loop(c, cl, fixed, c->table.width, err) && hs_loop_convert(c->loop, 0, err);
}

void hs_eval_case_close(hs_eval_case *c) {
    hs_loop_destroy(c->loop);
    hs_eval_table_free(&c->table);
    free(c->map);
    free(c->termination);
    hs_eval_source_close(&c->from);
    *c = (hs_eval_case){0};
}

/* ------------------------------------------------------------------------------------------- measure -- */

/* The frame with the knob at one position, into c->map. */
static bool frame_at(hs_eval_case *c, const hs_eval_values *values, const hs_eval_knob *knob, uint32_t i,
                     hs_frame *frame, hs_error *err) {
    hs_eval_values all = *values;
    return (!knob->exists || hs_eval_values_add(&all, knob->info.id, knob->value[i], err)) &&
           run_frame(c, &all, frame, c->map, err);
}

/* The knob at another position of the frame that was just run, without a new frame. */
static bool adjusted_at(hs_eval_case *c, const hs_eval_knob *knob, uint32_t i, hs_error *err) {
    hs_frame frame;
    const sv_param_value value = {.id = knob->info.id, .value = knob->value[i]};
    return hs_loop_adjust(c->loop, value, &frame, c->map, err);
}

bool hs_eval_case_measure(hs_eval_case *c, const hs_eval_values *values, const hs_eval_knob *knob,
                          hs_measures *out, sv_status *outcome, hs_error *err) {
    hs_frame frame;
    const bool adjustable = knob->exists && (knob->info.flags & SV_PARAM_ADJUST);
    if (!frame_at(c, values, knob, 0, &frame, err)) return false;
    const bool clipped = frame.clipped;
    *outcome = frame.outcome;
    hs_eval_measure_map(&c->table, c->map, &out[0]);
    for (uint32_t i = 1; i < knob->count; i++) {
        out[i] = out[0];
        if (adjustable && !clipped) continue; /* without a surface there is nothing to turn */
        if (adjustable ? !adjusted_at(c, knob, i, err) : !frame_at(c, values, knob, i, &frame, err))
            return false;
        hs_eval_measure_map(&c->table, c->map, &out[i]);
    }
    return true;
}

bool hs_eval_case_time(hs_eval_case *c, const hs_eval_values *values, uint32_t repeats, double *ms,
                       hs_error *err) {
    double times[MAX_REPEATS];
    hs_frame frame;
    assert(repeats >= 1 && repeats <= MAX_REPEATS);
    for (uint32_t i = 0; i < repeats; i++) {
        const double start = hs_now();
        if (!run_frame(c, values, &frame, NULL, err)) return false;
        times[i] = (hs_now() - start) * 1e3;
    }
    *ms = hs_timing_of(times, repeats).median;
    return true;
}

bool hs_eval_case_direct(hs_eval_case *c, const hs_eval_values *values, hs_measures *out, sv_status *outcome,
                         hs_error *err) {
    hs_frame frame;
    if (!run_frame(c, values, &frame, c->map, err) ||
        !hs_loop_ray_ends(c->loop, 0, &frame, c->termination, err))
        return false;
    *outcome = frame.outcome;
    hs_eval_measure_picture(&c->table, c->termination, out);
    return true;
}
