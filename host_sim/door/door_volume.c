/* SPDX-License-Identifier: MIT */
/* A volume in memory, taken: from numbers to levels, and what of them was scanned. */
#include "core/threads.h"
#include "door/door.h"
#include "volume/kretz.h"
#include "volume/levels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t count_of(const svh_voxels *v) {
    return (size_t)v->n[0] * v->n[1] * v->n[2];
}

enum { PIECE = 1024 };

static void read_values(const svh_voxels *v, uint64_t at, size_t count, double *out) {
    for (size_t i = 0; i < count; i++) out[i] = v->values ? v->values[at + i] : v->bytes[at + i];
}

/* What a mask hides is no constant. */
static bool read_unmasked(void *context, uint64_t at, size_t count, double *out, hs_error *err) {
    const svh_voxels *v = context;
    (void)err;
    read_values(v, at, count, out);
    for (size_t i = 0; v->mask && i < count; i++)
        if (!v->mask[at + i]) out[i] = NAN;
    return true;
}

static bool is_plain(const svh_voxels *v) {
    return v->bytes && v->window[0] == v->window[1];
}

static bool find_range(const svh_voxels *v, hs_levels *l, hs_error *err) {
    const bool plain = is_plain(v);
    double value[PIECE];
    hs_levels_begin(l);
    if (v->scanned == SVH_AUTO &&
        !hs_levels_find_outside(l, v->n, plain && !v->mask, read_unmasked, (void *)(uintptr_t)v, err))
        return false;
    for (size_t at = 0, n; v->values && at < count_of(v); at += n) {
        n = count_of(v) - at < PIECE ? count_of(v) - at : PIECE;
        read_values(v, at, n, value);
        hs_levels_widen(l, value, v->mask ? v->mask + at : NULL, n);
    }
    if (plain || v->window[0] < v->window[1]) {
        l->low = plain ? 0.0 : v->window[0];
        l->high = plain ? 255.0 : v->window[1];
    } else if (v->window[0] != v->window[1]) {
        return hs_fail(err, HS_ERR_USAGE, "window %g .. %g, expected the lower first", v->window[0],
                       v->window[1]);
    }
    return hs_levels_check(l, "the volume", err);
}

typedef struct {
    const svh_voxels *volume;
    const hs_levels *levels;
} filling;

static bool fill(void *context, size_t first, size_t count, uint8_t *out, hs_error *err) {
    const filling *f = context;
    const svh_voxels *v = f->volume;
    double value[PIECE];
    (void)err;
    if (is_plain(v) && !f->levels->has_outside) {
        memcpy(out, v->bytes + first, count);
        return true;
    }
    for (size_t at = 0, n; at < count; at += n) {
        n = count - at < PIECE ? count - at : PIECE;
        read_values(v, first + at, n, value);
        hs_levels_of(f->levels, value, n, out + at);
    }
    return true;
}

/* All but the voxels. */
static void describe(const svh_voxels *v, hs_volume *out) {
    *out = (hs_volume){.nx = v->n[0], .ny = v->n[1], .nz = v->n[2], .spacing_unsaid = v->unsaid != 0};
    for (int a = 0; a < 3; a++) out->spacing[a] = v->unsaid ? 1.0 : v->spacing[a];
    hs_pose_default(&out->pose);
    for (int i = 0; i < 9; i++) out->pose.stated |= v->direction[i] != 0.0;
    if (out->pose.stated) memcpy(out->pose.direction, v->direction, sizeof out->pose.direction);
    memcpy(out->pose.origin, v->origin, sizeof out->pose.origin);
    (void)snprintf(out->name, sizeof out->name, "the volume");
    out->probe = (hs_probe)v->probe;
    if (v->probe_said) hs_volume_scanned_from(out, out->probe);
    out->apex_said = v->apex_said != 0;
    memcpy(out->apex, v->apex, sizeof out->apex);
}

/* How it lies in the patient, and where the lines meet that scanned it. */
static bool check_place(const svh_voxels *v, hs_error *err) {
    static const double far_away = 1e30; /* mm: a vertex there is a float, too */
    bool stated = false;
    for (int i = 0; i < 9; i++) stated |= v->direction[i] != 0.0;
    if (stated && !hs_pose_is_right_angled(v->direction, DOOR_SKEW))
        return hs_fail(err, HS_ERR_INPUT,
                       "svh_voxels: direction is (%g %g %g) and so on, expected columns of length 1 at right "
                       "angles, or zeros",
                       v->direction[0], v->direction[1], v->direction[2]);
    for (int a = 0; a < 3; a++) {
        if (!(fabs(v->origin[a]) <= far_away))
            return hs_fail(err, HS_ERR_INPUT, "svh_voxels: origin[%d] is %g mm, expected -1e30 .. 1e30", a,
                           v->origin[a]);
        if (v->apex_said && !(fabs(v->apex[a]) <= far_away))
            return hs_fail(err, HS_ERR_INPUT, "svh_voxels: apex[%d] is %g mm, expected -1e30 .. 1e30", a,
                           v->apex[a]);
    }
    return true;
}

static bool check(const svh_voxels *v, hs_error *err) {
    uint64_t count = 1;
    if (!check_place(v, err)) return false;
    for (int a = 0; a < 3; a++) {
        if (v->n[a] < 1 || v->n[a] > HS_VOLUME_MAX_AXIS)
            return hs_fail(err, HS_ERR_INPUT, "the volume has %u voxels along %c, expected 1 .. %u", v->n[a],
                           "xyz"[a], HS_VOLUME_MAX_AXIS);
        if (!v->unsaid && !(v->spacing[a] >= 1e-6 && v->spacing[a] <= 1e6))
            return hs_fail(err, HS_ERR_INPUT, "the volume's spacing along %c is %g mm, expected 1e-6 .. 1e6",
                           "xyz"[a], v -> spacing[a]);
        count *= v->n[a];
    }
    if (count >= HS_VOLUME_MAX_VOXELS)
        return hs_fail(err, HS_ERR_INPUT, "the volume has %llu voxels, expected less than 2^31",
                       (unsigned long long)count);
    if (v->probe >= HS_PROBE_COUNT || v->scanned > SVH_ZEROS)
        return hs_fail(err, HS_ERR_USAGE,
                       "svh_voxels: probe is %u and scanned %u, expected 0 .. 5 and 0 .. 2", v->probe,
                       v->scanned);
    return (v->bytes == NULL) != (v->values == NULL) ||
           hs_fail(err, HS_ERR_USAGE, "svh_voxels: %s, expected bytes or values",
                   v->bytes ? "bytes and values" : "neither bytes nor values");
}

/* True if that volume of the file is what `bytes` are the copy of: `out` is the file's then. */
static bool take_kretz(const svh_voxels *v, hs_volume *out, hs_error *err) {
    const hs_kretz_options how = {.mirrored = v->mirrored != 0, .padding = (hs_padding)v->scanned};
    hs_kretz *file = hs_kretz_open(v->kretz, &how, err);
    *out = (hs_volume){0};
    bool same = file && v->number < hs_kretz_count(file) && hs_kretz_read(file, v->number, out, err) &&
                out->nx == v->n[0] && out->ny == v->n[1] && out->nz == v->n[2] && v->bytes;
    hs_kretz_close(file);
    for (size_t i = 0; same && i < count_of(v); i++) /* a black echo of a Cartesian file is 1 by now */
        same = out->voxels[i] == v->bytes[i] || out->voxels[i] + v->bytes[i] == 1;
    if (!same) hs_volume_free(out);
    return same;
}

static bool fill_levels(svh_volume *volume, const svh_voxels *v, hs_error *err) {
    hs_volume *to = &volume->volume;
    filling f = {v, &volume->levels};
    describe(v, to);
    to->voxels = hs_memory(1, count_of(v), "volume", err);
    if (!to->voxels || !hs_volume_fill(to, hs_thread_count(0), fill, &f, err)) return false;
    const bool guess = v->scanned == SVH_AUTO && !volume->levels.gaps;
    if (guess && !hs_levels_mark_unscanned(&volume->levels, to, err)) return false;
    if (v->scanned == SVH_ALL_SCANNED && !v->mask) hs_volume_mark_all_scanned(to);
    for (size_t i = 0; v->mask && i < count_of(v); i++)
        if (!v->mask[i])
            to->voxels[i] = 0;
        else if (v->scanned != SVH_AUTO && to->voxels[i] == 0)
            to->voxels[i] = 1;
    to->zeros_guessed &= !v->mask;
    return true;
}

static void find_course(svh_volume *volume) {
    hs_volume *v = &volume->volume;
    if (!hs_volume_doubt(v, volume->doubt)) volume->doubt[0] = '\0';
    volume->fitted = hs_volume_find_beams(v, &volume->host->fits);
    hs_course_question(v, volume->question, sizeof volume->question);
    hs_course_words(v, volume->beams, sizeof volume->beams);
}

svh_volume *door_volume(svh_host *host, hs_error *err) {
    svh_volume *volume = hs_memory(1, sizeof *volume, "volume", err);
    if (volume) volume->host = host;
    return volume;
}

void door_hand_out(svh_volume *volume, bool taken, svh_volume **out) {
    if (taken) {
        find_course(volume);
        volume->host->users++;
        *out = volume;
    } else if (volume) {
        hs_volume_free(&volume->volume);
        free(volume);
    }
}

static bool take(svh_volume *volume, const svh_voxels *given, hs_error *err) {
    if (!find_range(given, &volume->levels, err)) return false;
    const bool same = given->kretz && take_kretz(given, &volume->volume, err);
    if (same) volume->levels.has_outside = false;
    return err->code == HS_OK && (same || fill_levels(volume, given, err));
}

int32_t svh_volume_take(svh_host *host, const svh_voxels *given, svh_volume **out, svh_error *error) {
    hs_error err = {0};
    svh_voxels own;
    if (!DOOR_GIVEN(&err, host, given, out)) return door_leave(NULL, &err, error);
    *out = NULL;
    (void)pthread_mutex_lock(&host->lock);
    const bool good = DOOR_TAKE(svh_voxels, &own, given, &err) && check(&own, &err);
    svh_volume *volume = good ? door_volume(host, &err) : NULL;
    door_hand_out(volume, volume && take(volume, &own, &err), out);
    return door_leave(host, &err, error);
}

int32_t svh_volume_about(const svh_volume *volume, svh_about *out, svh_error *error) {
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, volume, out) || !DOOR_FITS(svh_about, out, &err))
        return door_leave(NULL, &err, error);
    const hs_volume *v = &volume->volume;
    const svh_about own = {.n = {v->nx, v->ny, v->nz},
                           .spacing = {v->spacing[0], v->spacing[1], v->spacing[2]},
                           .unsaid = v->spacing_unsaid,
                           .levels = v->voxels,
                           .low = volume->levels.low,
                           .high = volume->levels.high,
                           .outside = volume->levels.outside,
                           .has_outside = volume->levels.has_outside,
                           .has_beams = v->beams != NULL,
                           .fitted = volume->fitted,
                           .doubt = volume->doubt,
                           .question = volume->question,
                           .beams = volume->beams};
    door_give(out, &own, sizeof own);
    return SVH_OK;
}

void svh_volume_free(svh_volume *volume) {
    if (!volume) return;
    (void)pthread_mutex_lock(&volume->host->lock);
    if (volume->on_device) {
        hs_device_volume_destroy(volume->on_device);
        volume->host->on_device--;
        door_rest_device(volume->host);
    }
    door_let_go(volume->host);
    hs_volume_free(&volume->volume);
    free(volume);
}
