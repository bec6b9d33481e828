/* SPDX-License-Identifier: MIT */
#include "render/camera.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

/* Yaw about y, after pitch about x; columns are the turned axes. */
static void rotation_of(double yaw_deg, double pitch_deg, double out[9]) {
    double cy, sy, cp, sp;
    turn(yaw_deg, &cy, &sy);
    turn(pitch_deg, &cp, &sp);
    const double rotation[9] = {
        cy,  sy * sp, sy * cp, /* */
        0.0, cp,      -sp,     /* */
        -sy, cy * sp, cy * cp, /* */
    };
    memcpy(out, rotation, sizeof rotation);
}

static void multiply(const double a[9], const double b[9], double out[9]) {
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++)
            out[i * 3 + j] = a[i * 3] * b[j] + a[i * 3 + 1] * b[3 + j] + a[i * 3 + 2] * b[6 + j];
}

/* The camera's axes at yaw and pitch 0 for a place around the patient. World to volume is the transpose of
 * the directions. */
static void patient_axes(const hs_volume *volume, hs_from from, double out[9]) {
    static const double views[HS_FROM_COUNT][9] = {
        /* columns: the picture's right, its down, and where the camera looks; rows: left, back, head */
        [HS_FROM_ANTERIOR] = {1, 0, 0, 0, 0, 1, 0, -1, 0},
        [HS_FROM_POSTERIOR] = {-1, 0, 0, 0, 0, -1, 0, -1, 0},
        [HS_FROM_LEFT] = {0, 0, -1, 1, 0, 0, 0, -1, 0},
        [HS_FROM_RIGHT] = {0, 0, 1, -1, 0, 0, 0, -1, 0},
        [HS_FROM_SUPERIOR] = {-1, 0, 0, 0, 1, 0, 0, 0, -1},
        [HS_FROM_INFERIOR] = {1, 0, 0, 0, 1, 0, 0, 0, 1},
    };
    const double *d = volume->pose.direction;
    const double to_volume[9] = {d[0], d[3], d[6], d[1], d[4], d[7], d[2], d[5], d[8]};
    multiply(to_volume, views[from], out);
}

const char *hs_from_name(hs_from from) {
    static const char *const names[HS_FROM_COUNT] = {"probe", "anterior", "posterior", "left",
                                                     "right", "superior", "inferior"};
    return names[from];
}

/* The smallest box that holds the volume from here. */
static void fit_box(hs_camera *camera, const hs_volume *volume) {
    double size[3], box[3] = {0.0, 0.0, 0.0};
    volume_size_mm(volume, size);
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++) box[axis] += fabs(camera->rotation[k * 3 + axis]) * size[k];
    camera->extent = fmax(box[0], box[1]);
    camera->depth_extent = box[2];
}

void hs_camera_turn(hs_camera *camera, const hs_volume *volume, const double rotation[9]) {
    memcpy(camera->rotation, rotation, sizeof camera->rotation);
    fit_box(camera, volume);
}

void hs_camera_look_from(hs_camera *camera, const hs_volume *volume, hs_from from, double yaw_deg,
                         double pitch_deg) {
    double start[9], rotation[9];
    if (from == HS_FROM_PROBE)
        hs_probe_axes(volume, volume->probe, start);
    else
        patient_axes(volume, from, start);
    rotation_of(yaw_deg, pitch_deg, rotation);
    multiply(start, rotation, camera->rotation);
    fit_box(camera, volume);
}

void hs_camera_roll(hs_camera *camera, const hs_volume *volume, double roll_deg) {
    double c, s, axes[9];
    if (roll_deg == 0.0) return;
    turn(roll_deg, &c, &s);
    memcpy(axes, camera->rotation, sizeof axes);
    multiply(axes, (const double[9]){c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0}, camera->rotation);
    fit_box(camera, volume);
}

void hs_camera_look(hs_camera *camera, const hs_volume *volume, double yaw_deg, double pitch_deg) {
    hs_camera_look_from(camera, volume, HS_FROM_PROBE, yaw_deg, pitch_deg);
}

void hs_camera_tell(const hs_camera *camera, const hs_volume *volume, const uint32_t voxels[3],
                    hs_told *told) {
    const double *c = camera->rotation;
    const double to_camera[9] = {c[0], c[3], c[6], c[1], c[4], c[7], c[2], c[5], c[8]};
    const double box[3] = {camera->extent, camera->extent, camera->depth_extent};
    double from_probe[9], seen[9], turned[9], size[3];
    *told = (hs_told){.beams = (uint32_t)volume->course.kind};
    hs_probe_axes(volume, volume->probe, from_probe);
    multiply(to_camera, from_probe, seen);
    multiply(seen, volume->probe_turn, turned);
    for (int k = 0; k < 9; k++) told->rotation[k] = (float)(turned[k] + 0.0); /* no -0 */
    for (int k = 0; k < 3; k++) told->side[k] = (float)(0.0 - turned[k * 3 + 2]);
    if (volume->course.kind != HS_BEAMS_FAN) return;
    volume_size_mm(volume, size);
    told->sweep_mm = (float)volume->course.sweep;
    for (int k = 0; k < 3; k++) {
        double from_centre = 0.0;
        for (int m = 0; m < 3; m++)
            from_centre += to_camera[k * 3 + m] * (volume->course.apex[m] - 0.5 * size[m]);
        told->apex_mm[k] = (float)(from_centre + 0.5 * box[k] - 0.5 * box[k] / voxels[k]);
    }
}

void hs_camera_merge_box(hs_camera *camera, const hs_camera *other) {
    camera->extent = fmax(camera->extent, other->extent);
    camera->depth_extent = fmax(camera->depth_extent, other->depth_extent);
}

void hs_camera_hold_all(hs_camera *camera, const hs_volume *volume) {
    double size[3];
    volume_size_mm(volume, size);
    camera->extent = sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);
    camera->depth_extent = camera->extent;
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

bool hs_box_map_voxel(const hs_box_map *map, const hs_volume *volume, const double place[3], uint32_t at[3]) {
    const uint32_t count[3] = {volume->nx, volume->ny, volume->nz};
    for (int k = 0; k < 3; k++) {
        const double index =
            map->origin[k] + place[0] * map->du[k] + place[1] * map->dv[k] + place[2] * map->dw[k];
        const double nearest = floor(index + 0.5);
        if (!(nearest >= 0.0 && nearest < count[k])) return false;
        at[k] = (uint32_t)nearest;
    }
    return true;
}

bool hs_camera_in_patient(const hs_camera *camera, const hs_volume *volume, double out[9]) {
    if (volume->beams || !volume->pose.stated) return false;
    multiply(volume->pose.direction, camera->rotation, out);
    return true;
}

void hs_camera_mark(const hs_camera *camera, const hs_volume *volume, char *out, size_t bytes) {
    double r[9];
    const char *ends[2];
    if (volume->beams) {
        (void)snprintf(out, bytes, "%s", hs_beams_side_name(volume->beams));
    } else if (hs_camera_in_patient(camera, volume, r)) {
        const double right[3] = {r[0], r[3], r[6]}, up[3] = {-r[1], -r[4], -r[7]};
        hs_pose_ends(right, up, ends);
        (void)snprintf(out, bytes, "patient's %s at the right, %s at the top", ends[0], ends[1]);
    } else if (bytes > 0) {
        out[0] = '\0';
    }
}

void hs_camera_title(const char *title, const hs_camera *camera, const hs_volume *volume, char *out,
                     size_t bytes) {
    char mark[64];
    hs_camera_mark(camera, volume, mark, sizeof mark);
    (void)snprintf(out, bytes, "%s%s%s", title, mark[0] ? ", " : "", mark);
}
