/* SPDX-License-Identifier: MIT */
#include "volume/fan_kept.h"
#include "volume/fan_shape.h"

#include <stdlib.h>
#include <string.h>

enum { INPUTS = 19 };

struct hs_fit {
    double inputs[INPUTS]; /* what the fit reads beside the points; with the same, it comes to the same */
    hs_course course;
    hs_probe probe;
    double turn[9];
    double points[][3];
};

static void inputs_of(const hs_volume *v, const border *b, double out[INPUTS]) {
    memcpy(out, v->spacing, sizeof v->spacing);
    memcpy(out + 3, b->size, sizeof b->size);
    memcpy(out + 6, v->probe_turn, sizeof v->probe_turn);
    out[15] = v->probe;
    out[16] = b->count;
    out[17] = v->spacing_unsaid;
    out[18] = hs_pose_is_mirrored(&v->pose);
}

static bool alike(const double *a, const double *b, size_t count) {
    size_t i = 0;
    while (i < count && a[i] == b[i]) i++;
    return i == count;
}

hs_fit *hs_fit_begin(const hs_volume *v, const border *b) {
    hs_fit *fit = calloc(1, sizeof *fit + b->count * sizeof *fit->points);
    if (!fit) return NULL;
    inputs_of(v, b, fit->inputs);
    memcpy(fit->points, b->points, b->count * sizeof *fit->points);
    return fit;
}

void hs_fits_keep(hs_fits *fits, hs_fit *fit, const hs_volume *v) {
    if (!fit) return;
    fit->course = v->course;
    fit->probe = v->probe;
    memcpy(fit->turn, v->probe_turn, sizeof fit->turn);
    hs_fit **place = &fits->kept[fits->next++ % HS_FITS_KEPT];
    free(*place);
    *place = fit;
}

bool hs_fits_recall(const hs_fits *fits, hs_volume *v, const border *b) {
    double inputs[INPUTS];
    inputs_of(v, b, inputs);
    for (int i = 0; i < HS_FITS_KEPT; i++) {
        const hs_fit *fit = fits->kept[i];
        if (!fit || !alike(fit->inputs, inputs, INPUTS)) continue;
        if (!alike(fit->points[0], b->points[0], 3 * (size_t)b->count)) continue;
        v->course = fit->course;
        v->probe = fit->probe;
        memcpy(v->probe_turn, fit->turn, sizeof fit->turn);
        return true;
    }
    return false;
}

void hs_fits_free(hs_fits *fits) {
    for (int i = 0; i < HS_FITS_KEPT; i++) free(fits->kept[i]);
    *fits = (hs_fits){0};
}
