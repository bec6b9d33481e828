/* SPDX-License-Identifier: MIT */
/* The orthographic camera and the box it looks into; depths and pixels in the box, in millimetres. */
#pragma once

#include "volume/volume.h"

/*
 * The view box is a camera-aligned box around the volume's centre. Its x and y extents are equal (square
 * pixels), its z extent is the depth that rays are walked. Pixel (i, j) of a W x H image looks along the ray
 * through box coordinates ((i + 0.5) / W * extent, (j + 0.5) / H * extent); low-resolution slice s of S has
 * its centre at depth (s + 0.5) / S * depth_extent. So one box serves the slabs, the depthmap and the
 * picture, and a pixel of one lies over the same tissue as a pixel of another.
 */
typedef struct {
    double rotation[9];  /* row-major; columns are the camera's x, y, z axes in volume coordinates (mm) */
    double extent;       /* mm, width and height of the box */
    double depth_extent; /* mm, depth of the box */
} hs_camera;

/* From where a camera looks while yaw and pitch are 0. */
typedef enum {
    HS_FROM_PROBE = 0, /* from volume->probe along the beams */
    HS_FROM_ANTERIOR,  /* from the patient's front; the head is up, as in the next three */
    HS_FROM_POSTERIOR,
    HS_FROM_LEFT, /* from the patient's left */
    HS_FROM_RIGHT,
    HS_FROM_SUPERIOR, /* from the head; the front is up, as in the next one */
    HS_FROM_INFERIOR,
    HS_FROM_COUNT
} hs_from;

/* "probe", "anterior", ...: for command lines and files. */
const char *hs_from_name(hs_from from);

/*
 * Camera at `from`, then rotated by yaw (about its y) and by pitch (about its own x), in degrees: yaw > 0
 * turns the view to the picture's right, pitch > 0 up. Multiples of 90 degrees are exact. The box is the
 * smallest that holds the volume seen from here.
 *
 * From a probe at slice 0 the picture's x, y and depth are the volume's axes, and the camera looks along
 * (sin yaw cos pitch, -sin pitch, cos yaw cos pitch). From a probe at another face the volume is turned by
 * the quarter turns that bring that face to the front (+z: about y; -x and +x: about y; -y and +y: about x).
 * If the volume's axes are left-handed (hs_pose_is_mirrored), the picture's x is reversed, so that it shows
 * the patient and not a mirror image. The six other places need volume->pose.
 */
void hs_camera_look_from(hs_camera *camera, const hs_volume *volume, hs_from from, double yaw_deg,
                         double pitch_deg);

/* Rolls the camera about the direction in which it looks: > 0 turns its picture clockwise, degrees; 0 changes
 * nothing. The box is the smallest from there. */
void hs_camera_roll(hs_camera *camera, const hs_volume *volume, double roll_deg);

/* Turns it so that its axes are the columns of `rotation`, and fits its box. */
void hs_camera_turn(hs_camera *camera, const hs_volume *volume, const double rotation[9]);

/* Looks from the probe, as hs_camera_look_from does from other places. */
void hs_camera_look(hs_camera *camera, const hs_volume *volume, double yaw_deg, double pitch_deg);

/* What a frame tells of the probe and its beams: the fields of sv_frame, along the camera's axes. */
typedef struct {
    float rotation[9], side[3]; /* zeros if nobody knows where the probe was */
    uint32_t beams;             /* hs_beam_kind */
    float apex_mm[3], sweep_mm; /* from the centre of the first voxel of the box */
} hs_told;

/* The same for a box of so many voxels (x, y, z) that `camera` looks into. */
void hs_camera_tell(const hs_camera *camera, const hs_volume *volume, const uint32_t voxels[3],
                    hs_told *told);

/* Enlarges the box of `camera` so that it holds the box of `other` (an orbit uses one box for all views). */
void hs_camera_merge_box(hs_camera *camera, const hs_camera *other);

/* Makes the box of `camera` one that holds the volume from every direction: a cube with the volume's
 * diagonal. */
void hs_camera_hold_all(hs_camera *camera, const hs_volume *volume);

/* The affine map from normalised box coordinates (u, v, w in 0..1) to voxel indices (voxel centres at
 * integers): index = origin + u * du + v * dv + w * dw. */
typedef struct {
    double origin[3], du[3], dv[3], dw[3];
} hs_box_map;
void hs_camera_box_map(const hs_camera *camera, const hs_volume *volume, hs_box_map *map);

/* The voxel nearest to a place of the box; false if it lies outside the volume. */
bool hs_box_map_voxel(const hs_box_map *map, const hs_volume *volume, const double place[3], uint32_t at[3]);

/* Where the picture's axes run in the patient: row-major, columns are the picture's right, down and away,
 * rows the patient's left, back and head. False, and nothing set, if the file does not say how the patient
 * lies. */
bool hs_camera_in_patient(const hs_camera *camera, const hs_volume *volume, double out[9]);

/* What is known about left and right in a picture that `camera` takes of `volume`: "patient's left at the
 * right, head at the top", by the closest directions, if the file says how the patient lies; of a probe's
 * volume hs_beams_side_name; else "". At most 64 bytes. */
void hs_camera_mark(const hs_camera *camera, const hs_volume *volume, char *out, size_t bytes);

/* The mark behind a title and a comma; the title alone if there is no mark. */
void hs_camera_title(const char *title, const hs_camera *camera, const hs_volume *volume, char *out,
                     size_t bytes);
