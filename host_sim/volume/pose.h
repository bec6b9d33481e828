/* SPDX-License-Identifier: MIT */
/* How a volume lies in the patient, and on which of its faces the probe is. */
#ifndef HS_POSE_H
#define HS_POSE_H

#include <stdbool.h>
#include <stddef.h>

/*
 * World coordinates are millimetres; +x runs to the patient's left, +y to the back (posterior), +z to the
 * head (superior): LPS, as in DICOM, ITK and MetaImage. A voxel's index i is found at origin + direction *
 * (i[0] * spacing[0], i[1] * spacing[1], i[2] * spacing[2]).
 */
typedef struct {
    double origin[3];    /* mm; where the centre of voxel (0, 0, 0) lies */
    double direction[9]; /* row-major; column a is where index a grows to. Orthonormal; det -1: left-handed */
    bool stated;         /* the file says how the patient lies; else only lengths and angles hold */
    char contradicted[4]; /* orientation letters of the file that the directions contradict, or "" */
} hs_pose;

/* The face of the volume that the probe touches. The beams run from it to the opposite one. */
typedef enum {
    HS_PROBE_LOW_Z = 0, /* slice 0: the beams run along +z */
    HS_PROBE_HIGH_Z,
    HS_PROBE_LOW_Y,
    HS_PROBE_HIGH_Y,
    HS_PROBE_LOW_X,
    HS_PROBE_HIGH_X,
    HS_PROBE_COUNT
} hs_probe;

/* Directions along the world's axes, origin 0, nothing stated. */
void hs_pose_default(hs_pose *pose);

/* True if the axes are left-handed: what is drawn along them without care is a mirror image. */
bool hs_pose_is_mirrored(const hs_pose *pose);

/* Where the index (voxel centres at integers) lies in the world, mm. */
void hs_pose_world(const hs_pose *pose, const double spacing[3], const double index[3], double world[3]);

/* Three letters, by the closest direction of each axis: where it comes from, as in AnatomicalOrientation.
 * "RAI": x runs from right to left, y from the front to the back, z from the feet to the head. */
void hs_pose_letters(const hs_pose *pose, char letters[4]);

/* Sets the directions from such letters, in any case; false, and nothing changed, if they are none. */
bool hs_pose_from_letters(hs_pose *pose, const char *letters);

/* "x to the left, y to the back, z to the head"; for an axis that is more than a degree off, also by how
 * much: "x to the left (12 degrees off)". */
void hs_pose_words(const hs_pose *pose, char *out, size_t bytes);

/* The ends of the patient's axes ("left", "front", "head", ...; static) that two directions at right angles
 * are closest to, and never one axis for both. They are given along the volume's axes. */
void hs_pose_ends(const hs_pose *pose, const double first[3], const double second[3], const char *out[2]);

/* "-z", "+z", ..: the name of a face on command lines. */
const char *hs_probe_name(hs_probe probe);

#endif
