/* SPDX-License-Identifier: MIT */
#include "volume/fan_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * A fan whose lengths along one axis are wrong is none, so its outline tells which spacing it has: up to a
 * factor for all axes, which leaves it a fan. Two scales are sought, from a scan as long as it is wide and
 * deep: what is found does not depend on the lengths that were said. Of these as many stay as fit.
 */

static const double better = 0.05; /* of the border: as much more must lie on the fan, for the unknown more */
static const double enough = 0.9;  /* of the border */
static const double changed = 1.1; /* a smaller factor bends a fan, and leaves it one */
static const double alike = 1.05;  /* a smaller factor is what the outline's voxels leave open */
static const double hopeless =
    0.25; /* cost of a trial: most of the border is near a fan that will hold enough */
static const double side = 100.0; /* mm, of the cube that trials begin from */
static const double longer = 1.7;

typedef struct {
    border scaled;
    double (*points)[3];
    double *room;
    bool turned, found;
    double share, factor[3]; /* of the best so far */
} search;

static void scale_border(search *s, const hs_volume *v, const border *b, const double factor[3]) {
    s->scaled = *b;
    s->scaled.close = 1.0;
    for (int k = 0; k < 3; k++) s->scaled.close = fmax(s->scaled.close, v->spacing[k] * factor[k]);
    s->scaled.points = (const double(*)[3])s->points;
    for (uint32_t i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++) s->points[i][k] = b->points[i][k] * factor[k];
    for (int k = 0; k < 3; k++) s->scaled.size[k] = b->size[k] * factor[k];
}

/* From any face: with other lengths, the one that it narrows to need not be the one that seemed so. */
static void try_factor(search *s, const hs_volume *v, const border *b, const double factor[3]) {
    scale_border(s, v, b, factor);
    for (int face = 0; face < HS_PROBE_COUNT; face++) {
        double axes[9];
        hs_probe_axes(v, (hs_probe)face, axes);
        const fan f = hs_fan_from(axes, &s->scaled, s->room, s->turned, true, hopeless);
        if (!hs_fan_scale_rests(&f) || f.share <= s->share) continue;
        if (!hs_fan_holds(&f, &s->scaled, axes)) continue;
        s->share = f.share;
        s->found = true;
        for (int k = 0; k < 3; k++) s->factor[k] = factor[k] * f.factor[k];
    }
}

/* What makes a cube of the border's box. */
static void find_cube(const border *b, double factor[3]) {
    for (int k = 0; k < 3; k++) {
        double low = b->points[0][k], high = low;
        for (uint32_t i = 1; i < b->count; i++) {
            low = fmin(low, b->points[i][k]);
            high = fmax(high, b->points[i][k]);
        }
        factor[k] = side / fmax(high - low, 1e-9);
    }
}

/* From the cube, and from what is longer along two axes than along the third. */
static void try_shapes(search *s, const hs_volume *v, const border *b, const double cube[3]) {
    for (int axis = -1; axis < 3 && !s->found; axis++) {
        double factor[3];
        for (int k = 0; k < 3; k++) factor[k] = cube[k] * (axis >= 0 && k != axis ? longer : 1.0);
        try_factor(s, v, b, factor);
    }
}

static bool is_alike(double a, double b) {
    return fmax(a, b) <= fmin(a, b) * alike;
}

/* The lengths that were said, in the first order in which their ratios are the fan's. */
static bool are_ordered(const double said[3], const double factor[3], double spacing[3]) {
    static const int orders[5][3] = {{0, 2, 1}, {1, 0, 2}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
    for (int n = 0; n < 5; n++) {
        double off[3];
        for (int k = 0; k < 3; k++) off[k] = said[orders[n][k]] / (said[k] * factor[k]);
        if (!is_alike(off[0], off[1]) || !is_alike(off[1], off[2]) || !is_alike(off[0], off[2])) continue;
        for (int k = 0; k < 3; k++) spacing[k] = said[orders[n][k]];
        return true;
    }
    return false;
}

/* Two that fit one another stay; else the first does. */
static void keep_said(const double said[3], const double factor[3], double spacing[3]) {
    int kept = 0, also = 0;
    for (int k = 0; k < 3; k++)
        if (is_alike(factor[k], factor[(k + 1) % 3])) {
            kept = k;
            also = (k + 1) % 3;
        }
    const double whole = sqrt(factor[kept] * factor[also]);
    for (int k = 0; k < 3; k++) spacing[k] = k == kept || k == also ? said[k] : said[k] * factor[k] / whole;
}

static bool are_changed(const double said[3], const double spacing[3]) {
    double most = 1.0;
    for (int k = 0; k < 3; k++) most = fmax(most, fmax(spacing[k] / said[k], said[k] / spacing[k]));
    return most > changed;
}

bool hs_fan_find_scale(const hs_volume *v, const border *b, double share, double *room, double spacing[3]) {
    search s = {.points = malloc((size_t)HS_BORDER_MOST * sizeof *s.points),
                .share = fmax(enough, share + better)};
    s.room = room;
    if (!s.points || s.share >= 1.0) {
        free(s.points);
        return false;
    }
    double cube[3], fits[3];
    find_cube(b, cube);
    for (int turned = 0; turned < 2 && !s.found; turned++) {
        s.turned = turned == 1;
        try_shapes(&s, v, b, cube);
    }
    free(s.points);
    if (!s.found) return false;
    if (!are_ordered(v->spacing, s.factor, fits)) keep_said(v->spacing, s.factor, fits);
    if (!are_changed(v->spacing, fits)) return false;
    memcpy(spacing, fits, sizeof fits);
    return true;
}
