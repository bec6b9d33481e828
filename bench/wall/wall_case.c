/* SPDX-License-Identifier: MIT */
#include "wall/wall_case.h"

#include "quality/surf_case.h"
#include "volume/metaimage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define T_LOW       (40.5f / 255.0f)
#define T_HIGH      0.45f
#define TERMINATION 0.95f

float wall_termination(const uint8_t *voxels, size_t plane, uint32_t nz, size_t pixel, uint32_t start) {
    float opacity = 0.0f;
    for (uint32_t z = start; z < nz; z++) {
        const float value = (float)voxels[z * plane + pixel] / 255.0f;
        opacity += (1.0f - opacity) * fminf(fmaxf((value - T_LOW) / (T_HIGH - T_LOW), 0.0f), 1.0f);
        if (opacity >= TERMINATION) return (float)z;
    }
    return (float)nz;
}

void wall_case_free(wall_case *c) {
    free(c->full);
    free(c->first);
    free(c->end);
    free(c->label);
    free(c->truth);
    *c = (wall_case){0};
}

/* Takes the voxels of a volume; it is empty afterwards. */
static void take(wall_case *c, hs_volume *v, const char *name) {
    (void)snprintf(c->name, sizeof c->name, "%.63s", name);
    c->nx = v->nx;
    c->ny = v->ny;
    c->nz = v->nz;
    memcpy(c->spacing_mm, v->spacing, sizeof c->spacing_mm);
    c->full = v->voxels;
    v->voxels = NULL;
    hs_volume_free(v);
}

static bool make_ranges(wall_case *c, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    c->first = calloc(plane, sizeof *c->first);
    c->end = calloc(plane, sizeof *c->end);
    if (!c->first || !c->end)
        return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", c->name, plane);
    for (size_t i = 0; i < plane; i++)
        for (uint32_t z = 0; z < c->nz; z++) {
            if (c->full[z * plane + i] == 0) continue;
            if (c->end[i] == 0) c->first[i] = (uint16_t)z;
            c->end[i] = (uint16_t)(z + 1);
        }
    return true;
}

/* Voxels as they are in the file; `wide`: of 16 bits that hold 0 .. 255. */
static bool read_as_it_is(const char *folder, const char *file, bool wide, hs_volume *out, hs_error *err) {
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/%s", folder, file);
    const hs_metaimage_options options = {
        .padding = HS_PADDING_ALL, .has_window = wide, .window_low = 0.0, .window_high = 255.0};
    return hs_metaimage_read(path, &options, out, err);
}

static bool read_range(const char *folder, const char *file, const wall_case *c, uint16_t **out,
                       hs_error *err) {
    hs_volume v;
    if (!read_as_it_is(folder, file, true, &v, err)) return false;
    const size_t plane = (size_t)c->nx * c->ny;
    const bool fits = v.nx == c->nx && v.ny == c->ny && v.nz == 1;
    if (!fits)
        (void)hs_fail(err, HS_ERR_INPUT, "%s/%s: %u x %u x %u, expected %u x %u x 1", folder, file, v.nx,
                      v.ny, v.nz, c->nx, c->ny);
    else if (!(*out = calloc(plane, sizeof **out)))
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu rays", file, plane);
    for (size_t i = 0; fits && *out && i < plane; i++) (*out)[i] = v.voxels[i];
    hs_volume_free(&v);
    return fits && *out;
}

static bool read_truth(const char *folder, const char *name, wall_case *c, hs_error *err) {
    const size_t plane = (size_t)c->nx * c->ny;
    char file[128];
    hs_volume v;
    (void)snprintf(file, sizeof file, "%s_label.mha", name);
    if (!read_as_it_is(folder, file, false, &v, err)) return false;
    const bool fits = v.nx == c->nx && v.ny == c->ny && v.nz == 1;
    c->label = v.voxels;
    if (!fits) return hs_fail(err, HS_ERR_INPUT, "%s/%s: not one label a ray", folder, file);
    (void)snprintf(file, sizeof file, "%s_truth.mha", name);
    if (!read_as_it_is(folder, file, false, &v, err)) return false;
    const bool same = v.nx == c->nx && v.ny == c->ny && v.nz == c->nz;
    c->truth = calloc(plane, sizeof *c->truth);
    for (size_t i = 0; same && c->truth && i < plane; i++)
        c->truth[i] = wall_termination(v.voxels, plane, c->nz, i, 0);
    hs_volume_free(&v);
    return (same && c->truth) || hs_fail(err, HS_ERR_INPUT, "%s/%s: not of the scan's size", folder, file);
}

bool wall_case_read(const char *folder, const char *name, wall_case *out, hs_error *err) {
    char file[128];
    hs_volume v;
    *out = (wall_case){0};
    (void)snprintf(file, sizeof file, "%s_full.mha", name);
    if (!read_as_it_is(folder, file, false, &v, err)) return false;
    take(out, &v, name);
    if (read_range(folder, "scan_first.mha", out, &out->first, err) &&
        read_range(folder, "scan_end.mha", out, &out->end, err) && read_truth(folder, name, out, err))
        return true;
    wall_case_free(out);
    return false;
}

bool wall_case_make(const char *scene, uint64_t seed, uint32_t pose, wall_case *out, hs_error *err) {
    surf_case c;
    *out = (wall_case){0};
    if (!surf_case_make(scene, 128 / SURF_FINE_PER_VOXEL, seed, pose, 0, &c, err)) return false;
    take(out, &c.fine.full, scene);
    out->label = c.fine.label;
    out->truth = c.truth;
    c.fine.label = NULL;
    c.truth = NULL;
    surf_case_free(&c);
    if (make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

bool wall_case_open(const char *path, wall_case *out, hs_error *err) {
    hs_volume v;
    *out = (wall_case){0};
    if (!hs_metaimage_read(path, NULL, &v, err)) return false;
    char name[64];
    (void)snprintf(name, sizeof name, "%.63s", v.name);
    take(out, &v, name);
    if (make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

/* Trilinear at (x, y, z) voxels, over scanned voxels only; 0 if they weigh less than half. */
static uint8_t sample(const wall_case *c, const double at[3]) {
    const uint32_t n[3] = {c->nx, c->ny, c->nz};
    double sum = 0.0, weight = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        double w = 1.0;
        size_t index = 0, stride = 1;
        for (int axis = 0; axis < 3; axis++) {
            const double low = floor(at[axis]), rest = at[axis] - low, i = low + (corner >> axis & 1);
            w *= corner >> axis & 1 ? rest : 1.0 - rest;
            if (i < 0.0 || i >= n[axis]) w = 0.0;
            if (w > 0.0) index += (size_t)i * stride;
            stride *= n[axis];
        }
        if (w <= 0.0 || c->full[index] == 0) continue;
        sum += w * c->full[index];
        weight += w;
    }
    return weight >= 0.5 ? (uint8_t)fmin(fmax(sum / weight + 0.5, 1.0), 255.0) : 0;
}

bool wall_case_turn(const wall_case *from, int axis, double degrees, uint32_t side, wall_case *out,
                    hs_error *err) {
    const double co = cos(degrees * acos(-1.0) / 180.0), si = sin(degrees * acos(-1.0) / 180.0);
    const uint32_t n[3] = {from->nx, from->ny, from->nz};
    double diagonal = 0.0;
    for (int i = 0; i < 3; i++) diagonal += n[i] * from->spacing_mm[i] * n[i] * from->spacing_mm[i];
    const double mm = sqrt(diagonal) / side;
    *out = (wall_case){.nx = side, .ny = side, .nz = side, .spacing_mm = {mm, mm, mm}};
    (void)snprintf(out->name, sizeof out->name, "%.50s %c %.0f", from->name, "xyz"[axis], degrees);
    out->full = calloc((size_t)side * side, side);
    if (!out->full) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %u^3 voxels", from->name, side);
    uint8_t *voxel = out->full;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++)
            for (uint32_t x = 0; x < side; x++) {
                double p[3] = {mm * (x + 0.5 - 0.5 * side), mm * (y + 0.5 - 0.5 * side),
                               mm * (z + 0.5 - 0.5 * side)};
                if (axis ==
                    2) { /* from the side: turning about the viewing direction alone would be one view */
                    const double swap = p[2];
                    p[2] = -p[1];
                    p[1] = swap;
                }
                double *a = &p[axis == 0 ? 1 : 0], *b = &p[axis == 2 ? 1 : 2];
                const double u = co * *a - si * *b, v = si * *a + co * *b;
                *a = u;
                *b = v;
                for (int i = 0; i < 3; i++) p[i] = p[i] / from->spacing_mm[i] + 0.5 * n[i] - 0.5;
                *voxel++ = sample(from, p);
            }
    if (make_ranges(out, err)) return true;
    wall_case_free(out);
    return false;
}

void wall_case_change(wall_case *c, double gain, double gamma, double black) {
    const size_t plane = (size_t)c->nx * c->ny;
    for (size_t i = 0; i < plane; i++)
        for (size_t z = c->first[i]; z < c->end[i]; z++) {
            const double level = 255.0 * pow(c->full[z * plane + i] / 255.0, gamma) * gain + black;
            c->full[z * plane + i] = (uint8_t)fmin(fmax(level + 0.5, 0.0), 255.0);
        }
}
