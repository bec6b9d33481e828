/* SPDX-License-Identifier: MIT */
#include "volume/fan_fit.h"

#include <math.h>

/* The fan of a course along the axes of the volume, with its borders as half-spaces: a place lies inside by
 * the least of its distances from them. */
typedef struct {
    double axes[9];                  /* row-major: the probe's axes in those of the volume */
    double low[2], high[2], side[2]; /* sine and cosine of the outer lines and planes */
    double room;                     /* mm inside the border: it is known to a voxel */
} borders;

static borders borders_of(const hs_volume *v) {
    const hs_course *c = &v->course;
    borders b = {.low = {sin(c->lines[0]), cos(c->lines[0])},
                 .high = {sin(c->lines[1]), cos(c->lines[1])},
                 .side = {sin(c->planes), cos(c->planes)}};
    double face[9];
    hs_probe_axes(v, v->probe, face);
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) b.axes[i] += face[i / 3 * 3 + k] * v->probe_turn[k * 3 + i % 3];
    for (int a = 0; a < 3; a++) b.room = fmax(b.room, v->spacing[a]);
    return b;
}

static bool lies_inside(const hs_course *c, const borders *b, const double at[3]) {
    double p[3] = {0};
    for (int k = 0; k < 3; k++)
        for (int m = 0; m < 3; m++) p[k] += b->axes[m * 3 + k] * (at[m] - c->apex[m]);
    const double w = p[2] - c->sweep, depth = sqrt(p[1] * p[1] + w * w) + c->sweep;
    const double radius = sqrt(p[0] * p[0] + depth * depth);
    return w > 0.0 && radius > c->radii[0] + b->room && radius < c->radii[1] - b->room &&
           w * b->side[0] - fabs(p[1]) * b->side[1] > b->room &&
           depth * b->high[0] - p[0] * b->high[1] > b->room && p[0] * b->low[1] - depth * b->low[0] > b->room;
}

void hs_volume_fill_fan(hs_volume *v) {
    const hs_course *c = &v->course;
    if (!v->zeros_guessed || c->kind != HS_BEAMS_FAN || !(c->radii[1] > 0.0)) return;
    const borders b = borders_of(v);
    uint8_t *voxel = v->voxels;
    for (uint32_t z = 0; z < v->nz; z++)
        for (uint32_t y = 0; y < v->ny; y++)
            for (uint32_t x = 0; x < v->nx; x++, voxel++) {
                const double at[3] = {(x + 0.5) * v->spacing[0], (y + 0.5) * v->spacing[1],
                                      (z + 0.5) * v->spacing[2]};
                if (*voxel == 0 && lies_inside(c, &b, at)) *voxel = 1;
            }
}
