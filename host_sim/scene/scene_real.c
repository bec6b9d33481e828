/* SPDX-License-Identifier: MIT */
/*
 * Synthetic occluders before a given volume, which then is its own ground truth. The volume is moved back to
 * make room; what lies before the first tissue of a column is taken as free; occluders are put there, and
 * kept a gap away from it.
 */
#include "core/threads.h"
#include "scene/scene_field.h"

#include <string.h>

#define FLUID_LEVEL 40   /* T_L = 40.5 / 255 (spec 9): above it is tissue */
#define GAP_MM      3.0f /* of fluid left between an occluder and the volume's tissue */

typedef struct {
    hs_field *field;
    const hs_volume *given;
    const uint32_t *front;
} real;

/* Makes a column scanned, as fluid, from the front to its first scanned voxel; one without any stays as it
 * is. */
static void open_column(hs_volume *v, size_t column) {
    const size_t plane = (size_t)v->nx * v->ny;
    uint32_t first = 0;
    while (first < v->nz && v->voxels[first * plane + column] == 0) first++;
    for (uint32_t z = 0; first < v->nz && z < first; z++) v->voxels[z * plane + column] = 1;
}

bool hs_scene_real_lead(hs_volume *given, double share, hs_error *err) {
    const uint32_t lead = (uint32_t)(given->nz * share / (1.0 - share) + 0.5);
    const size_t plane = (size_t)given->nx * given->ny;
    if (lead == 0) return true;
    hs_volume moved;
    if (!hs_volume_init(&moved, given->nx, given->ny, given->nz + lead, err)) return false;
    memcpy(moved.voxels + lead * plane, given->voxels, given->nz * plane);
    memcpy(moved.spacing, given->spacing, sizeof moved.spacing);
    moved.pose = given->pose;
    hs_pose_world(&given->pose, given->spacing, (double[3]){0, 0, -(double)lead}, moved.pose.origin);
    memcpy(moved.name, given->name, sizeof moved.name);
    for (size_t column = 0; column < plane; column++) open_column(&moved, column);
    hs_volume_free(given);
    *given = moved;
    return true;
}

/* True if the mean over the voxel and its neighbours is above T_L: a speck of noise is no tissue. */
static bool is_tissue(const hs_volume *v, uint32_t x, uint32_t y, uint32_t z) {
    uint32_t sum = 0, count = 0;
    for (uint32_t w = z ? z - 1 : 0; w <= z + 1 && w < v->nz; w++)
        for (uint32_t u = y ? y - 1 : 0; u <= y + 1 && u < v->ny; u++)
            for (uint32_t t = x ? x - 1 : 0; t <= x + 1 && t < v->nx; t++) {
                sum += v->voxels[((size_t)w * v->ny + u) * v->nx + t];
                count++;
            }
    return sum > FLUID_LEVEL * count;
}

/* The first slice of a column's tissue, or the number of slices. */
static uint32_t first_tissue(const hs_volume *v, uint32_t x, uint32_t y) {
    uint32_t z = 0;
    while (z < v->nz && !is_tissue(v, x, y, z)) z++;
    return z;
}

typedef struct {
    const hs_volume *given;
    uint32_t *front;
} search;

static void front_row(void *context, uint32_t y) {
    const search *s = context;
    for (uint32_t x = 0; x < s->given->nx; x++)
        s->front[(size_t)y * s->given->nx + x] = first_tissue(s->given, x, y);
}

void hs_scene_real_front(const hs_volume *given, uint32_t threads, uint32_t *front) {
    search s = {.given = given};
    s.front = front;
    hs_parallel(threads, given->ny, front_row, &s);
}

/* Takes the occluders away from where the given volume has tissue, and from the gap before it. */
static void place_row(void *context, uint32_t y) {
    const real *r = context;
    hs_field *f = r->field;
    const uint32_t gap = (uint32_t)ceilf(GAP_MM / f->h[2]);
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const uint32_t first = r->front[hs_field_index(f, x, y, 0)], from = f->first + f->low;
        const uint32_t behind = first > gap ? first - gap : 0;
        for (uint32_t z = (behind > from ? behind : from) - f->first; z < f->high; z++) {
            size_t index = hs_field_index(f, x, y, z);
            f->tissue[index] = HS_TISSUE_FLUID;
            f->surface[index] = HS_DISTANCE_FAR;
        }
    }
}

void hs_scene_real_place(hs_field *field, const uint32_t *front) {
    real r = {field, NULL, front};
    hs_parallel(field->threads, field->n[1], place_row, &r);
}

/* Before the tissue the brighter one counts; from it on, and where nothing was scanned, the given volume. */
static void combine_row(void *context, uint32_t y) {
    const real *r = context;
    hs_field *f = r->field;
    for (uint32_t x = 0; x < f->n[0]; x++) {
        const uint32_t first = r->front[hs_field_index(f, x, y, 0)];
        for (uint32_t z = 0; z < f->n[2]; z++) {
            size_t index = hs_field_index(f, x, y, z);
            uint8_t given = r->given->voxels[index];
            if (z >= first) f->tissue[index] = HS_TISSUE_SOFT;
            if (z >= first || given == 0 || given > f->grey[index]) f->grey[index] = given;
        }
    }
}

void hs_scene_real_combine(hs_field *field, const hs_volume *given, const uint32_t *front) {
    real r = {field, given, front};
    hs_parallel(field->threads, field->n[1], combine_row, &r);
}
