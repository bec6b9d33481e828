/* SPDX-License-Identifier: MIT */
#include "wall/wall_still.h"

#include "wall/wall_judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 8 };

/* Maps of the scene's rays. */
typedef struct {
    float *depth, *confidence, *end, *last_end, *last_truth;
    uint8_t *last_label;
    double result, truth;
    uint64_t rays; /* added up so far */
} still;

static void still_free(still *s) {
    free(s->depth);
    free(s->confidence);
    free(s->end);
    free(s->last_end);
    free(s->last_truth);
    free(s->last_label);
}

static bool still_make(still *s, size_t plane, hs_error *err) {
    s->depth = calloc(plane, sizeof *s->depth);
    s->confidence = calloc(plane, sizeof *s->confidence);
    s->end = calloc(plane, sizeof *s->end);
    s->last_end = calloc(plane, sizeof *s->last_end);
    s->last_truth = calloc(plane, sizeof *s->last_truth);
    s->last_label = calloc(plane, 1);
    return (s->depth && s->confidence && s->end && s->last_end && s->last_truth && s->last_label) ||
           hs_fail(err, HS_ERR_MEMORY, "flicker: no memory for %zu rays", plane);
}

/* Adds what changed since the frame before, where a ray was labelled in both. */
static void add(still *s, const wall_case *c, bool first) {
    const size_t plane = (size_t)c->nx * c->ny;
    for (size_t i = 0; i < plane; i++) {
        s->end[i] = wall_termination(c->full, plane, c->nz, i, wall_start(s->depth[i], c->nz));
        if (first || c->label[i] == 0 || s->last_label[i] == 0) continue;
        s->result += fabs((double)(s->end[i] - s->last_end[i])) * 128.0 / c->nz;
        s->truth += fabs((double)(c->truth[i] - s->last_truth[i])) * 128.0 / c->nz;
        s->rays++;
    }
    memcpy(s->last_end, s->end, plane * sizeof *s->end);
    memcpy(s->last_truth, c->truth, plane * sizeof *c->truth);
    memcpy(s->last_label, c->label, plane);
}

static bool frame(still *s, const wall_case *c, const sv_wall_settings *settings, bool first, hs_error *err) {
    sv_wall_outcome outcome;
    const sv_wall_volume v = wall_case_volume(c);
    if (first && !still_make(s, (size_t)c->nx * c->ny, err)) return false;
    if (!sv_wall_surface(&v, settings, s->depth, s->confidence, &outcome, NULL))
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory", c->name);
    add(s, c, first);
    return true;
}

bool wall_still(const char *scene, uint64_t seed, uint32_t pose, const sv_wall_settings *settings,
                wall_flicker *out, hs_error *err) {
    still s = {0};
    bool ok = true;
    for (uint64_t n = 0; ok && n < FRAMES; n++) {
        wall_case c;
        ok = wall_case_make(scene, seed + n, pose, 0, &c, err);
        if (!ok) break;
        ok = frame(&s, &c, settings, n == 0, err);
        wall_case_free(&c);
    }
    const double rays = s.rays ? (double)s.rays : 1.0;
    *out = (wall_flicker){s.result / rays, s.truth / rays};
    still_free(&s);
    return ok;
}
