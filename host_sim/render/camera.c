/* SPDX-License-Identifier: MIT */
#include "render/camera.h"

#include <math.h>

#define RADIANS_PER_DEGREE 0.017453292519943295

/* Cosine and sine that are exact at multiples of 90 degrees, so that such views stay axis-aligned. */
static void turn(double degrees, double *cosine, double *sine) {
    double quarter = degrees / 90.0;
    if (quarter == nearbyint(quarter)) {
        static const double cosines[4] = {1.0, 0.0, -1.0, 0.0};
        int index = (int)(fmod(fmod(quarter, 4.0) + 4.0, 4.0));
        *cosine = cosines[index];
        *sine = cosines[(index + 3) % 4];
        return;
    }
    *cosine = cos(degrees * RADIANS_PER_DEGREE);
    *sine = sin(degrees * RADIANS_PER_DEGREE);
}

static void volume_size_mm(const hs_volume *volume, double size[3]) {
    size[0] = volume->nx * volume->spacing[0];
    size[1] = volume->ny * volume->spacing[1];
    size[2] = volume->nz * volume->spacing[2];
}

void hs_camera_look(hs_camera *camera, const hs_volume *volume, double yaw_deg, double pitch_deg) {
    double cy, sy, cp, sp;
    turn(yaw_deg, &cy, &sy);
    turn(pitch_deg, &cp, &sp);
    const double rotation[9] = {
        cy,  sy * sp, sy * cp, /* yaw about y, after pitch about x */
        0.0, cp,      -sp,     /* */
        -sy, cy * sp, cy * cp, /* */
    };
    double size[3], box[3] = {0.0, 0.0, 0.0};
    volume_size_mm(volume, size);
    for (int axis = 0; axis < 3; axis++) {
        for (int k = 0; k < 3; k++) {
            camera->rotation[k * 3 + axis] = rotation[k * 3 + axis];
            box[axis] += fabs(rotation[k * 3 + axis]) * size[k];
        }
    }
    camera->extent = fmax(box[0], box[1]);
    camera->depth_extent = box[2];
}

void hs_camera_merge_box(hs_camera *camera, const hs_camera *other) {
    camera->extent = fmax(camera->extent, other->extent);
    camera->depth_extent = fmax(camera->depth_extent, other->depth_extent);
}

void hs_camera_box_map(const hs_camera *camera, const hs_volume *volume, hs_box_map *map) {
    const double count[3] = {volume->nx, volume->ny, volume->nz};
    for (int k = 0; k < 3; k++) {
        const double *row = camera->rotation + (size_t)k * 3;
        map->du[k] = row[0] * camera->extent / volume->spacing[k];
        map->dv[k] = row[1] * camera->extent / volume->spacing[k];
        map->dw[k] = row[2] * camera->depth_extent / volume->spacing[k];
        map->origin[k] = 0.5 * (count[k] - 1.0) - 0.5 * (map->du[k] + map->dv[k] + map->dw[k]);
    }
}
