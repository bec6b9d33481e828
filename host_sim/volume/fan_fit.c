/* SPDX-License-Identifier: MIT */
#include "volume/fan_fit.h"
#include "volume/fan_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double clear = 0.95;    /* and as much if it is not turned */
static const double followed = 0.92; /* and this share of what lies near: the rest is cut off */
static const double hopeless = 0.4;  /* cost of a trial */
static const double whole = 0.93;    /* of the border of a scan that nothing was cut from */

/* The radius at which the middle line enters the volume. */
static double first_scanned(const fan *f, const border *b) {
    double enters = 0.0;
    for (int k = 0; k < 3; k++) {
        const double along = f->rotation[k * 3 + 2], from = along > 0.0 ? 0.0 : b->size[k];
        if (fabs(along) > 1e-6) enters = fmax(enters, (from - f->x[PLACE + k]) / along);
    }
    return enters;
}

/* An outline that runs beside the fan instead of along it, like a box with oblique sides, tells where the
 * probe was. That the beams are a fan it does not tell: then they count as parallel. */
static void take(hs_volume *v, hs_probe face, const fan *f, const border *b) {
    double axes[9];
    hs_course *c = &v->course;
    hs_probe_axes(v, face, axes);
    c->kind = f->follows >= followed ? HS_BEAMS_FAN : HS_BEAMS_PARALLEL;
    if (c->kind == HS_BEAMS_FAN) {
        memcpy(c->apex, f->x + PLACE, sizeof c->apex);
        c->sweep = f->x[SWEEP];
        c->face = f->on[4] > b->count / 20 ? f->x[FACE] : first_scanned(f, b);
        c->misfit = f->median;
        if (f->share >= whole && f->on[4] > b->count / 100) memcpy(c->radii, f->x + FACE, sizeof c->radii);
        memcpy(c->lines, f->x + LOW_LINE, sizeof c->lines);
        c->planes = f->x[PLANE];
    }
    v->probe = face;
    for (int i = 0; i < 9; i++) { /* from the probe's axes to those of who looks from the face */
        v->probe_turn[i] = 0.0;
        for (int k = 0; k < 3; k++) v->probe_turn[i] += axes[k * 3 + i / 3] * f->rotation[k * 3 + i % 3];
    }
}

/* The best fan from a face, and how well it fits: 1 and more if it holds. */
static double try_face(const hs_volume *v, hs_probe face, const border *b, double *room, fan *best) {
    double axes[9], fits = 0.0;
    hs_probe_axes(v, face, axes);
    for (int turned = 0; turned < 2 && fits < 1.0 + clear; turned++) {
        const fan f = hs_fan_from(axes, b, room, turned == 1, false, hopeless);
        const double now = f.share + (hs_fan_holds(&f, b, axes) ? 1.0 : 0.0);
        if (now < fits) continue;
        fits = now;
        *best = f;
    }
    return fits;
}

/* Tries the faces, the stated one first, and says which two fit best. True with the fan of the first if it is
 * clear; else what to ask. */
static bool choose_face(const hs_volume *v, const border *b, double *room, hs_course *c, hs_probe face[2],
                        fan *best) {
    const bool stated = c->kind == HS_BEAMS_PARALLEL;
    double first = -1.0, second = -1.0;
    uint32_t held = 0;
    for (int n = 0; n < HS_PROBE_COUNT; n++) {
        const hs_probe at = (hs_probe)(((int)v->probe + n) % HS_PROBE_COUNT);
        fan f;
        const double fits = try_face(v, at, b, room, &f);
        held += fits > 1.0;
        if (fits > first) {
            second = first;
            face[1] = face[0];
            first = fits;
            face[0] = at;
            *best = f;
        } else if (fits > second) {
            second = fits;
            face[1] = at;
        }
        if (stated && n == 0 && held == 1) break;
    }
    if (held == 1 && (!stated || face[0] == v->probe)) return true;
    const bool narrows = first > second + 0.1, there = stated && face[0] == v->probe;
    const bool ahead = narrows && !there;
    c->fits_none = narrows && there;
    c->asked[0] = face[0];
    c->asked[1] = face[1];
    c->asked_count = held > 1 ? 2 : ahead ? 1 : 0;
    return false;
}

/* All that the outline tells. */
static void fit(hs_volume *v, const border *b, double *room) {
    hs_course *c = &v->course;
    hs_probe face[2] = {v->probe, v->probe};
    fan best = {0};
    const bool stated = c->kind == HS_BEAMS_PARALLEL;
    const bool held = choose_face(v, b, room, c, face, &best);
    if (held && v->spacing_unsaid) { /* a fan in unknown units tells a face, and no place */
        c->asked[0] = face[0];
        c->asked_count = stated ? 0 : 1;
    } else if (held) {
        c->found = !stated;
        take(v, face[0], &best, b);
    }
    const double taken = c->kind == HS_BEAMS_FAN ? best.share : 0.0;
    if (!v->spacing_unsaid) (void)hs_fan_find_scale(v, b, taken, room, c->fits);
}

/* True: that took a fit. */
static bool fit_once(hs_volume *v, const border *b, double *room, hs_fits *fits) {
    if (b->count < HS_BORDER_LEAST || (fits && hs_fits_recall(fits, v, b))) return false;
    hs_fit *begun = fits ? hs_fit_begin(v, b) : NULL;
    fit(v, b, room);
    if (fits) hs_fits_keep(fits, begun, v);
    return true;
}

bool hs_volume_find_beams(hs_volume *v, hs_fits *fits) {
    hs_course *c = &v->course;
    border b = {0};
    const bool stated = hs_probe_is_known(v);
    *c = (hs_course){.kind = stated ? HS_BEAMS_PARALLEL : HS_BEAMS_UNKNOWN};
    if (v->beams) {
        c->kind = HS_BEAMS_FAN;
        for (int k = 0; k < 3; k++) c->apex[k] = 0.0 - v->beams->corner[k];
        c->sweep = v->beams->axis;
        c->face = v->beams->start;
        return false;
    }
    char doubt[HS_DOUBT_BYTES];
    if (!v->spacing_unsaid && hs_volume_doubt(v, doubt))
        return false; /* of wrong lengths a fan tells nothing */
    double *memory = malloc((size_t)HS_BORDER_MOST * 4 * sizeof *memory); /* without it, nothing is found */
    if (!memory) return false;
    double *room = memory + 3 * (size_t)HS_BORDER_MOST;
    hs_border_find(v, &b, (double(*)[3])(void *)memory);
    const bool fitted = fit_once(v, &b, room, fits);
    if (c->kind != HS_BEAMS_FAN) hs_course_find_noise(v);
    if (c->kind == HS_BEAMS_PARALLEL && v->apex_said && !v->spacing_unsaid) hs_course_take_said(v);
    hs_volume_fill_fan(v);
    free(memory);
    return fitted;
}

void hs_volume_share_beams(hs_volume *v, const hs_volume *found) {
    v->probe = found->probe;
    memcpy(v->probe_turn, found->probe_turn, sizeof v->probe_turn);
    v->course = found->course;
    hs_volume_fill_fan(v);
}
