/* SPDX-License-Identifier: MIT */
/* Distances to solids, and lists of them. */
#include "scene/scene_solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void to_local(const hs_solid *s, const float p[3], float q[3]) {
    const float d[3] = {p[0] - s->centre[0], p[1] - s->centre[1], p[2] - s->centre[2]};
    for (int i = 0; i < 3; i++) {
        const float *row = s->axis + (size_t)i * 3;
        q[i] = row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
    }
}

/* First-order distance to an ellipsoid: k0 (k0 - 1) / |grad|, exact on the surface to first order. */
static float ellipsoid(const float q[3], const float r[3]) {
    float a = q[0] / r[0], b = q[1] / r[1], c = q[2] / r[2];
    float k0 = sqrtf(a * a + b * b + c * c);
    if (k0 < 1e-3f) return -fminf(r[0], fminf(r[1], r[2]));
    a /= r[0], b /= r[1], c /= r[2];
    float k1 = sqrtf(a * a + b * b + c * c);
    return k0 * (k0 - 1.0f) / k1;
}

static float cone(const hs_solid *s, const float p[3]) {
    const float b[3] = {s->end[0] - s->centre[0], s->end[1] - s->centre[1], s->end[2] - s->centre[2]};
    const float a[3] = {p[0] - s->centre[0], p[1] - s->centre[1], p[2] - s->centre[2]};
    float bb = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    float t = bb > 0.0f ? (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / bb : 0.0f;
    t = fminf(fmaxf(t, 0.0f), 1.0f);
    const float e[3] = {a[0] - t * b[0], a[1] - t * b[1], a[2] - t * b[2]};
    return sqrtf(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) - (s->r0 + t * (s->r1 - s->r0));
}

float hs_solid_distance(const hs_solid *s, const float p[3]) {
    if (s->shape == HS_SOLID_CONE) return cone(s, p);
    float q[3];
    to_local(s, p, q);
    float d = ellipsoid(q, s->radii);
    if (s->shape == HS_SOLID_ELLIPSOID) return d;
    d = fabsf(d) - 0.5f * s->thickness;
    if (s->shape == HS_SOLID_SHELL) return d;
    float y = q[1] + s->tilt * q[2];
    float band = fabsf(y - s->pitch * rintf(y / s->pitch)) - 0.22f * s->pitch;
    return fmaxf(d, fmaxf(band, fabsf(y) - s->span));
}

void hs_rotation(const float deg[3], float axis[9]) {
    const double to_rad = 3.14159265358979323846 / 180.0;
    double sx = sin(deg[0] * to_rad), cx = cos(deg[0] * to_rad);
    double sy = sin(deg[1] * to_rad), cy = cos(deg[1] * to_rad);
    double sz = sin(deg[2] * to_rad), cz = cos(deg[2] * to_rad);
    /* Rows are the images of the unit vectors under Rz Ry Rx. */
    const double r[9] = {cy * cz,
                         cy * sz,
                         -sy,
                         sx * sy * cz - cx * sz,
                         sx * sy * sz + cx * cz,
                         sx * cy,
                         cx * sy * cz + sx * sz,
                         cx * sy * sz - sx * cz,
                         cx * cy};
    for (int i = 0; i < 9; i++) axis[i] = (float)r[i];
}

hs_solid_frame hs_frame_at(const float origin[3], const float deg[3]) {
    hs_solid_frame frame = {.origin = {origin[0], origin[1], origin[2]}, .scale = 1.0f};
    hs_rotation(deg, frame.axis);
    return frame;
}

void hs_frame_point(const hs_solid_frame *f, const float p[3], float out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] =
            f->origin[i] + f->scale * (p[0] * f->axis[i] + p[1] * f->axis[3 + i] + p[2] * f->axis[6 + i]);
}

static hs_solid *add(hs_solid_list *list, hs_solid_shape shape, hs_solid_part part, hs_tissue tissue) {
    if (list->count == list->capacity) {
        size_t capacity = list->capacity ? 2 * list->capacity : 128;
        hs_solid *items = realloc(list->items, capacity * sizeof *items);
        if (!items) {
            list->out_of_memory = true;
            return NULL;
        }
        list->items = items;
        list->capacity = capacity;
    }
    hs_solid *s = &list->items[list->count++];
    memset(s, 0, sizeof *s);
    s->shape = shape;
    s->part = part;
    s->tissue = tissue;
    return s;
}

/* A box that holds the ellipsoid whatever its rotation: its half widths are |axis^T r|. */
static void ellipsoid_bounds(hs_solid *s, float margin) {
    for (int i = 0; i < 3; i++) {
        float half = 0.0f;
        for (int k = 0; k < 3; k++)
            half += (s->axis[3 * k + i] * s->radii[k]) * (s->axis[3 * k + i] * s->radii[k]);
        half = sqrtf(half) + margin;
        s->low[i] = s->centre[i] - half;
        s->high[i] = s->centre[i] + half;
    }
}

hs_solid *hs_solid_ellipsoid(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                             hs_tissue tissue, float blend, const float centre[3], const float radii[3]) {
    hs_solid *s = add(list, HS_SOLID_ELLIPSOID, part, tissue);
    if (!s) return NULL;
    hs_frame_point(frame, centre, s->centre);
    memcpy(s->axis, frame->axis, sizeof s->axis);
    for (int i = 0; i < 3; i++) s->radii[i] = frame->scale * radii[i];
    s->blend = frame->scale * blend;
    ellipsoid_bounds(s, s->blend);
    return s;
}

hs_solid *hs_solid_cone(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                        hs_tissue tissue, float blend, const float from[3], float r0, const float to[3],
                        float r1) {
    hs_solid *s = add(list, HS_SOLID_CONE, part, tissue);
    if (!s) return NULL;
    hs_frame_point(frame, from, s->centre);
    hs_frame_point(frame, to, s->end);
    s->r0 = frame->scale * r0;
    s->r1 = frame->scale * r1;
    s->blend = frame->scale * blend;
    float margin = fmaxf(s->r0, s->r1) + s->blend;
    for (int i = 0; i < 3; i++) {
        s->low[i] = fminf(s->centre[i], s->end[i]) - margin;
        s->high[i] = fmaxf(s->centre[i], s->end[i]) + margin;
    }
    return s;
}

hs_solid *hs_solid_shell(hs_solid_list *list, const hs_solid_frame *frame, hs_solid_part part,
                         hs_tissue tissue, const float centre[3], const float radii[3], float thickness) {
    hs_solid *s = hs_solid_ellipsoid(list, frame, part, tissue, 0.0f, centre, radii);
    if (!s) return NULL;
    s->shape = HS_SOLID_SHELL;
    s->thickness = frame->scale * thickness;
    ellipsoid_bounds(s, s->thickness);
    return s;
}

hs_solid *hs_solid_ribs(hs_solid_list *list, const hs_solid_frame *frame, const float centre[3],
                        const float radii[3], float thickness, float pitch, float tilt, float span) {
    hs_solid *s = hs_solid_shell(list, frame, HS_PART_BONE, HS_TISSUE_BONE, centre, radii, thickness);
    if (!s) return NULL;
    s->shape = HS_SOLID_RIBS;
    s->pitch = frame->scale * pitch;
    s->tilt = tilt;
    s->span = frame->scale * span;
    return s;
}

static int by_part(const void *a, const void *b) {
    const hs_solid *s = a, *t = b;
    if (s->part != t->part) return s->part < t->part ? -1 : 1;
    return s->order < t->order ? -1 : 1;
}

void hs_solid_list_sort(hs_solid_list *list) {
    for (size_t i = 0; i < list->count; i++) list->items[i].order = (uint32_t)i;
    if (list->count) qsort(list->items, list->count, sizeof *list->items, by_part);
}

uint32_t hs_solid_list_bodies(const hs_solid_list *list) {
    uint32_t bodies = 1;
    for (size_t i = 0; i < list->count; i++)
        if (list->items[i].body >= bodies) bodies = list->items[i].body + 1u;
    return bodies;
}

void hs_solid_list_free(hs_solid_list *list) {
    free(list->items);
    memset(list, 0, sizeof *list);
}
