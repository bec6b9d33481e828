/* SPDX-License-Identifier: MIT */
#include "seen/seen.h"

#include "core/threads.h"
#include "loop/lowres.h"
#include "loop/marks.h"
#include "loop/slabs.h"
#include "plugin/reason.h"
#include "volume/fan_fit.h"
#include "volume/kretz.h"
#include "volume/levels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static _Thread_local hs_error last;
static hs_cl device; /* zeroed: not open */
static hs_fits fits;

const char *hs_seen_error(void) {
    return last.text;
}

static bool check_size(uint32_t given, size_t ours, const char *what) {
    last = (hs_error){0};
    return given == ours || hs_fail(&last, HS_ERR_USAGE, "%s: %u bytes, expected %zu", what, given, ours);
}

/* ---------------------------------------------------------------------------------------- levels -- */

enum { PIECE = 1 << 16 };

static size_t count_of(const hs_seen_volume *v) {
    return (size_t)v->n[0] * v->n[1] * v->n[2];
}

static bool read_values(void *context, uint64_t at, size_t count, double *out, hs_error *err) {
    const hs_seen_volume *v = context;
    (void)err;
    for (size_t i = 0; i < count; i++) out[i] = v->values ? v->values[at + i] : v->bytes[at + i];
    return true;
}

/* What a mask hides is no constant. */
static bool read_unmasked(void *context, uint64_t at, size_t count, double *out, hs_error *err) {
    const hs_seen_volume *v = context;
    const bool ok = read_values(context, at, count, out, err);
    for (size_t i = 0; v->mask && i < count; i++)
        if (!v->mask[at + i]) out[i] = NAN;
    return ok;
}

static bool is_plain(const hs_seen_volume *v) {
    return v->bytes && v->window[0] == v->window[1];
}

static bool find_range(const hs_seen_volume *v, hs_levels *l) {
    const bool plain = is_plain(v);
    double value[1024];
    hs_levels_begin(l);
    if (v->padding == HS_SEEN_AUTO &&
        !hs_levels_find_outside(l, v->n, plain && !v->mask, read_unmasked, (void *)(uintptr_t)v, &last))
        return false;
    for (size_t at = 0, n; v->values && at < count_of(v); at += n) {
        n = count_of(v) - at < 1024 ? count_of(v) - at : 1024;
        (void)read_values((void *)(uintptr_t)v, at, n, value, NULL);
        hs_levels_widen(l, value, v->mask ? v->mask + at : NULL, n);
    }
    if (plain || v->window[0] < v->window[1]) {
        l->low = plain ? 0.0 : v->window[0];
        l->high = plain ? 255.0 : v->window[1];
    } else if (v->bytes) {
        return hs_fail(&last, HS_ERR_USAGE, "window %g .. %g, expected the lower first", v->window[0],
                       v->window[1]);
    }
    return hs_levels_check(l, "the volume", &last);
}

typedef struct {
    const hs_seen_volume *volume;
    const hs_levels *levels;
} filling;

static bool fill(void *context, size_t first, size_t count, uint8_t *out, hs_error *err) {
    const filling *f = context;
    const hs_seen_volume *v = f->volume;
    double value[1024];
    if (is_plain(v) && !f->levels->has_outside) {
        memcpy(out, v->bytes + first, count);
        return true;
    }
    for (size_t at = 0, n; at < count; at += n) {
        n = count - at < 1024 ? count - at : 1024;
        (void)read_values((void *)(uintptr_t)v, first + at, n, value, err);
        hs_levels_of(f->levels, value, n, out + at);
    }
    return true;
}

static hs_volume volume_of(const hs_seen_volume *v) {
    hs_volume out = {
        .nx = v->n[0], .ny = v->n[1], .nz = v->n[2], .spacing_unsaid = v->unsaid != 0, .voxels = v->levels};
    for (int a = 0; a < 3; a++) out.spacing[a] = v->unsaid ? 1.0 : v->spacing[a];
    memcpy(out.pose.direction, v->direction, sizeof out.pose.direction);
    (void)snprintf(out.name, sizeof out.name, "the volume");
    out.probe = (hs_probe)v->probe;
    if (v->probe_said) hs_volume_scanned_from(&out, out.probe);
    out.apex_said = v->apex_said != 0;
    memcpy(out.apex, v->apex, sizeof out.apex);
    return out;
}

_Static_assert(sizeof(hs_volume) <= sizeof((hs_seen_volume *)0)->found, "found has room for it");

/* What hs_seen_take found out, with the levels as they lie now. */
static hs_volume found_volume(const hs_seen_volume *v) {
    hs_volume out;
    memcpy(&out, v->found, sizeof out);
    out.voxels = v->levels;
    return out;
}

static bool check_volume(const hs_seen_volume *v) {
    uint64_t count = 1;
    for (int a = 0; a < 3; a++) {
        if (v->n[a] < 1 || v->n[a] > HS_VOLUME_MAX_AXIS)
            return hs_fail(&last, HS_ERR_INPUT, "the volume has %u voxels along %c, expected 1 .. %u",
                           v->n[a], "xyz"[a], HS_VOLUME_MAX_AXIS);
        count *= v->n[a];
    }
    return (count < HS_VOLUME_MAX_VOXELS && v->probe < HS_PROBE_COUNT) ||
           hs_fail(&last, HS_ERR_INPUT, "the volume has %llu voxels, expected less than 2^31",
                   (unsigned long long)count);
}

/* *same: `out` is the volume of the file that `bytes` are the copy of, its voxels in `levels`. */
static bool take_kretz(const hs_seen_volume *v, hs_volume *out, bool *same) {
    const hs_kretz_options how = {.mirrored = v->mirrored != 0, .padding = (hs_padding)v->padding};
    hs_kretz *file = hs_kretz_open(v->kretz, &how, &last);
    *out = (hs_volume){0};
    *same = file && v->number < hs_kretz_count(file) && hs_kretz_read(file, v->number, out, &last) &&
            out->nx == v->n[0] && out->ny == v->n[1] && out->nz == v->n[2] && v->bytes;
    hs_kretz_close(file);
    for (size_t i = 0; *same && i < count_of(v); i++) /* a black echo of a Cartesian file is 1 by now */
        *same = out->voxels[i] == v->bytes[i] || out->voxels[i] + v->bytes[i] == 1;
    if (*same) memcpy(v->levels, out->voxels, count_of(v));
    free(out->voxels);
    out->voxels = v->levels;
    if (!*same) hs_beams_free(out->beams);
    return last.code == HS_OK;
}

static void find_course(hs_seen_volume *v, hs_volume *volume) {
    if (!hs_volume_doubt(volume, v->doubt)) v->doubt[0] = '\0';
    v->fitted = hs_volume_find_beams(volume, &fits);
    hs_course_question(volume, v->question, sizeof v->question);
    hs_course_words(volume, v->beams, sizeof v->beams);
    v->has_beams = volume->beams != NULL;
    memcpy(v->found, volume, sizeof *volume);
}

int32_t hs_seen_take(hs_seen_volume *v) {
    hs_levels levels;
    hs_volume volume;
    bool same = false;
    if (!check_size(v->size, sizeof *v, "hs_seen_volume") || !check_volume(v) || !find_range(v, &levels))
        return 0;
    v->low = levels.low;
    v->high = levels.high;
    v->outside = levels.outside;
    v->has_outside = levels.has_outside;
    if (v->kretz && !take_kretz(v, &volume, &same)) return 0;
    if (same) {
        v->has_outside = 0;
        find_course(v, &volume);
        return 1;
    }
    filling f = {v, &levels};
    volume = volume_of(v);
    const bool guess = v->padding == HS_SEEN_AUTO && !levels.gaps;
    if (!hs_volume_fill(&volume, hs_thread_count(0), fill, &f, &last)) return 0;
    if (guess && !hs_levels_mark_unscanned(&levels, &volume, &last)) return 0;
    if (v->padding == HS_SEEN_ALL_SCANNED && !v->mask) hs_volume_mark_all_scanned(&volume);
    for (size_t i = 0; v->mask && i < count_of(v); i++)
        v->levels[i] = !v->mask[i] ? 0 : v->levels[i] || v->padding == HS_SEEN_AUTO ? v->levels[i] : 1;
    volume.zeros_guessed &= !v->mask;
    find_course(v, &volume);
    return 1;
}

void hs_seen_drop(hs_seen_volume *v) {
    hs_volume volume = found_volume(v);
    hs_beams_free(volume.beams);
    memset(v->found, 0, sizeof v->found);
}

/* ------------------------------------------------------------------------------------------ view -- */

static hs_camera camera_of(const hs_seen_volume *v, const hs_seen_view *view) {
    const hs_volume volume = found_volume(v);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    if (view->turned) hs_camera_turn(&camera, &volume, view->rotation);
    return camera;
}

int32_t hs_seen_plan(const hs_seen_volume *v, hs_seen_view *view) {
    if (!check_size(view->size, sizeof *view, "hs_seen_view") || !check_volume(v)) return 0;
    const hs_volume volume = found_volume(v);
    const hs_camera camera = camera_of(v, view);
    if (!hs_lowres_size(&volume, view->lowres, &camera, view->n, &last)) return 0;
    memcpy(view->rotation, camera.rotation, sizeof camera.rotation);
    view->box[0] = camera.extent;
    view->box[1] = camera.depth_extent;
    hs_told told;
    hs_camera_tell(&camera, &volume, view->n, &told);
    memcpy(view->probe_rotation, told.rotation, sizeof told.rotation);
    memcpy(view->probe_side, told.side, sizeof told.side);
    memcpy(view->beam_apex_mm, told.apex_mm, sizeof told.apex_mm);
    view->beams = told.beams;
    view->beam_sweep_mm = told.sweep_mm;
    return 1;
}

static bool convert(const hs_volume *volume, const hs_camera *camera, const hs_seen_view *view,
                    uint8_t *voxels, uint16_t *ranges) {
    const hs_slab_layout layout = {.width = view->n[0],
                                   .height = view->n[1],
                                   .slices = view->n[2],
                                   .slab_slices = view->n[2],
                                   .tiles_x = 1,
                                   .tile_w = view->n[0],
                                   .tile_h = view->n[1],
                                   .row_pitch = view->n[0]};
    const size_t pixels = (size_t)view->n[0] * view->n[1];
    sv_slab slab;
    sv_frame frame = {0};
    hs_slabs *slabs = NULL;
    hs_device_volume *source = hs_device_volume_create(&device, volume, &last);
    bool ok = source &&
              (slabs = hs_slabs_create(&device, &layout, SV_CARRIER_HOST, HS_FAN_RANGES, volume->beams, NULL,
                                       &last)) &&
              hs_slabs_convert(slabs, source, camera, &last) &&
              hs_cl_check(clFinish(device.queue), "clFinish (scan conversion)", &last);
    if (ok) {
        hs_slabs_describe(slabs, 0, &slab);
        hs_slabs_describe_frame(slabs, true, &frame);
        memcpy(voxels, slab.memory, pixels * view->n[2]);
        memcpy(ranges, frame.scanned, pixels * sizeof *frame.scanned);
    }
    hs_slabs_destroy(slabs);
    if (source) hs_device_volume_destroy(source);
    return ok;
}

int32_t hs_seen_look(const hs_seen_volume *v, const hs_seen_view *view, uint8_t *voxels, uint16_t *ranges) {
    if (!check_size(view->size, sizeof *view, "hs_seen_view") || !check_volume(v)) return 0;
    if (!device.context && !hs_cl_open(&device, &last)) return 0;
    const hs_volume volume = found_volume(v);
    const hs_camera camera = camera_of(v, view);
    return convert(&volume, &camera, view, voxels, ranges);
}

int32_t hs_seen_mark(const hs_seen_volume *v, const hs_seen_view *view, const void *marks, uint32_t count,
                     float *depth) {
    if (!check_size(view->size, sizeof *view, "hs_seen_view") || !check_volume(v)) return 0;
    const hs_volume volume = found_volume(v);
    const hs_camera camera = camera_of(v, view);
    return hs_marks_apply(marks, count, &volume, &camera, view->n, depth, &last);
}

int32_t hs_seen_reason(const void *report, char words[320]) {
    return hs_reason_words(report, words);
}

void hs_seen_close(void) {
    if (device.context) hs_cl_close(&device);
    device = (hs_cl){0};
    hs_fits_free(&fits);
}
