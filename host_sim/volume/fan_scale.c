/* SPDX-License-Identifier: MIT */
#include "volume/fan_shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * A fan whose lengths along one axis are wrong is none, so its outline tells which spacing it has: up to a
 * factor for all axes, which leaves it a fan. Looked for are an axis that is too long or too short, and the
 * three spacings in another order, as of an array that was transposed and kept those it had.
 */

static const double better = 0.05; /* of the border: as much more must lie on the fan, for the unknown more */
static const double enough = 0.85; /* of the border */
static const double changed = 1.1; /* a smaller factor bends a fan, and leaves it one */
static const double hardly = 200.0; /* mm: of a longer radius the lines hardly part, and bend by chance */
static const double hopeless =
    0.25; /* cost of a trial: most of the border is near a fan that will hold enough */
static const double first[] = {0.5, 2.0};

typedef struct {
    border scaled;
    double (*points)[3];
    double *room;
    const hs_probe *faces; /* NULL: all, in their order */
    int face_count;
    bool turned, found;
    double share, factor[3]; /* of the best so far */
} search;

static void scale_border(search *s, const border *b, const double factor[3]) {
    s->scaled = *b;
    s->scaled.points = (const double(*)[3])s->points;
    for (uint32_t i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++) s->points[i][k] = b->points[i][k] * factor[k];
    for (int k = 0; k < 3; k++) s->scaled.size[k] = b->size[k] * factor[k];
}

/* From each of the faces. */
static void try_factor(search *s, const hs_volume *v, const border *b, const double factor[3], int axis) {
    scale_border(s, b, factor);
    for (int n = 0; n < s->face_count; n++) {
        double axes[9];
        hs_probe_axes(v, s->faces ? s->faces[n] : (hs_probe)n, axes);
        const fan f = hs_fan_from(axes, &s->scaled, s->room, s->turned, axis, hopeless);
        if (!hs_fan_scale_rests(&f) || f.share <= s->share || f.x[FACE] > hardly) continue;
        if (!hs_fan_holds(&f, &s->scaled, axes)) continue;
        s->share = f.share;
        s->found = true;
        for (int k = 0; k < 3; k++) s->factor[k] = factor[k] * f.factor[k];
    }
}

/* The largest, or its reciprocal where lengths become shorter. */
static double most_change(const double factor[3]) {
    double most = 1.0;
    for (int k = 0; k < 3; k++) most = fmax(most, fmax(factor[k], 1.0 / factor[k]));
    return most;
}

static bool are_equal(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* From any face: with other lengths along all axes, the one that it narrows to need not be among the best.
 * Of a volume with two equal spacings, orders come twice. */
static void try_orders(search *s, const hs_volume *v, const border *b) {
    static const int orders[5][3] = {{0, 2, 1}, {1, 0, 2}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}};
    double factors[5][3];
    s->faces = NULL;
    s->face_count = HS_PROBE_COUNT;
    for (int n = 0; n < 5; n++) {
        bool is_new = true;
        for (int k = 0; k < 3; k++) factors[n][k] = v->spacing[orders[n][k]] / v->spacing[k];
        for (int m = 0; m < n; m++) is_new = is_new && !are_equal(factors[m], factors[n]);
        if (is_new && most_change(factors[n]) > changed) try_factor(s, v, b, factors[n], -1);
    }
}

static void try_axes(search *s, const hs_volume *v, const border *b, const hs_probe faces[2]) {
    s->faces = faces;
    s->face_count = faces[1] == faces[0] ? 1 : 2;
    for (int axis = 0; axis < 3; axis++)
        for (size_t n = 0; n < sizeof first / sizeof *first; n++) {
            double factor[3] = {1.0, 1.0, 1.0};
            factor[axis] = first[n];
            try_factor(s, v, b, factor, axis);
        }
}

bool hs_fan_find_scale(const hs_volume *v, const border *b, const hs_probe faces[2], double share,
                       double *room, double spacing[3]) {
    if (share > enough) return false;
    search s = {.points = malloc((size_t)HS_BORDER_MOST * sizeof *s.points),
                .share = fmax(enough, share + better),
                .factor = {1.0, 1.0, 1.0}};
    if (!s.points) return false;
    s.room = room;
    for (int turned = 0; turned < 2 && !s.found; turned++) {
        s.turned = turned == 1;
        try_orders(&s, v, b);
        try_axes(&s, v, b, faces);
    }
    free(s.points);
    if (!s.found || most_change(s.factor) <= changed) return false;
    for (int k = 0; k < 3; k++) spacing[k] = v->spacing[k] * s.factor[k];
    return true;
}
