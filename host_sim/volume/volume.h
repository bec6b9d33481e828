/* SPDX-License-Identifier: MIT */
/* A source volume as the host keeps it: 8-bit voxels on a regular grid, x fastest, then y, then z, and how it
 * lies in the patient. */
#pragma once

#include "core/error.h"
#include "volume/beams.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * World coordinates are millimetres; +x runs to the patient's left, +y to the back (posterior), +z to the
 * head (superior): LPS, as in DICOM, ITK and MetaImage. A voxel's index i is found at origin + direction *
 * (i[0] * spacing[0], i[1] * spacing[1], i[2] * spacing[2]).
 */
typedef struct {
    double origin[3];    /* mm; where the centre of voxel (0, 0, 0) lies */
    double direction[9]; /* row-major; column a is where index a grows to. Orthonormal; det -1: left-handed */
    bool stated;         /* the file says how the patient lies; else only lengths and angles hold */
    char contradicted[4]; /* orientation letters of the file that do not count, or "" */
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

/* How the beams run; the values are those of sv_frame.beams. */
typedef enum { HS_BEAMS_UNKNOWN = 0, HS_BEAMS_PARALLEL = 1, HS_BEAMS_FAN = 2 } hs_beam_kind;

/* The beams along the probe's axes (hs_volume.probe and probe_turn). Lengths are mm. */
typedef struct {
    hs_beam_kind kind;
    double apex[3]; /* of a fan: where the lines of its middle plane meet, from the volume's corner */
    double sweep;   /* from there, along the probe's z, to the axis that is swept about; parallel to its x */
    double face;    /* radius at which the lines begin */
    /* All of the scan's border is the fan's: it lies between these radii, angles of the outer lines, and this
     * angle of the outer planes to either side; radii of 0: not so. */
    double radii[2], lines[2], planes;
    double misfit;     /* half of the scan's border lies closer to the fan; 0: the file says the fan */
    bool found;        /* the probe's face was found in the fan: nobody stated it */
    hs_probe asked[2]; /* faces where the probe may be, if that is worth a question */
    uint32_t asked_count;
    double
        fits[3]; /* mm: with this spacing a fan fits, and with the volume's own none; of zeros: none found */
    bool fits_none; /* the probe's face was stated and the scan narrows to it, but is no fan from there */
    bool noisy;     /* corners are dark, and not alike: perhaps nothing was scanned there */
    bool blank;     /* corners have one level that was said to be scanned: likewise */
} hs_course;

/* Directions along the world's axes, origin 0, nothing stated. */
void hs_pose_default(hs_pose *pose);

/* True if the axes are the world's, as ITK and PLUS write for whatever they know nothing of. */
bool hs_pose_is_identity(const hs_pose *pose);

/* True if the axes are left-handed: what is drawn along them without care is a mirror image. */
bool hs_pose_is_mirrored(const hs_pose *pose);

/* True if the columns are directions of length 1 at right angles to each other: squared lengths miss 1, and
 * scalar products 0, by `skew` at most. */
bool hs_pose_is_right_angled(const double direction[9], double skew);

/* Where the index (voxel centres at integers) lies in the world, mm. */
void hs_pose_world(const hs_pose *pose, const double spacing[3], const double index[3], double world[3]);

enum { HS_SIZE_BYTES = 200, HS_DOUBT_BYTES = 200 };

/* True, with a sentence, if letters of the file contradict its directions. */
bool hs_pose_doubt(const hs_pose *pose, char out[HS_DOUBT_BYTES]);

/* Three letters, by the closest direction of each axis: where it comes from, as in AnatomicalOrientation.
 * "RAI": x runs from right to left, y from the front to the back, z from the feet to the head. */
void hs_pose_letters(const hs_pose *pose, char letters[4]);

/* Sets the directions from such letters, in any case; false, and nothing changed, if they are none. */
bool hs_pose_from_letters(hs_pose *pose, const char *letters);

/* "x to the left, y to the back, z to the head"; for an axis that is more than a degree off, also by how
 * much: "x to the left (12 degrees off)". */
void hs_pose_words(const hs_pose *pose, char *out, size_t bytes);

/* The ends of the patient's axes ("left", "front", "head", ...; static) that two directions of the world, at
 * right angles, are closest to, and never one axis for both. */
void hs_pose_ends(const double first[3], const double second[3], const char *out[2]);

/* "-z", "+z", ..: the name of a face on command lines. */
const char *hs_probe_name(hs_probe probe);

#define HS_VOLUME_MAX_AXIS   2048u               /* voxels along one axis */
#define HS_VOLUME_MAX_VOXELS (UINT64_C(1) << 31) /* voxels of a volume */

/*
 * Voxel (x, y, z) is voxels[(z * ny + y) * nx + x]; its centre stands at ((x + 0.5) * spacing[0], ...) mm
 * from the volume's corner. `pose` says where that is in the patient, `probe` from where it was scanned.
 *
 * The value 0 means "not scanned" (outside the fan) and nothing else: scanned voxels hold 1 .. 255. A reader
 * that meets zeros inside the scanned region raises them to 1 (hs_volume_mark_unscanned). So
 * the host can tell the plugin padding_value = 0.
 */
typedef struct {
    uint32_t nx, ny, nz;
    double spacing[3];   /* mm, > 0 */
    bool zeros_guessed;  /* nobody said what was scanned: zeros that the border reaches may be black fluid */
    bool spacing_unsaid; /* nobody said it: a voxel is 1 of an unknown unit, and its sides may differ */
    hs_pose pose;        /* of zeros: unknown, and seen from the probe as the default one is */
    hs_probe probe;
    double
        probe_turn[9]; /* row-major: the probe's axes (x along its array, z along the beams) in those of who
                          looks from `probe`. Identity but for a scene's turned camera; zeros: unknown */
    bool apex_said;    /* the file says where the lines meet that scanned it: `apex`, and `probe` is stated */
    double apex[3];    /* mm along the volume's axes, from its corner */
    hs_course course;  /* of zeros: not looked for */
    uint8_t *voxels;   /* nx * ny * nz bytes, owned */
    hs_beams *beams;   /* in probe geometry, what this is the Cartesian copy of; owned; NULL: there is none */
    char name[256];    /* for messages and captions: a file's name or a scene's */
} hs_volume;

/* Allocates zeroed voxels, spacing 1 mm, the default pose, the probe at slice 0, empty name. What the struct
 * held before is overwritten, not freed. On failure the struct is all zero: HS_ERR_INPUT if a dimension is 0
 * or above HS_VOLUME_MAX_AXIS or if there are more than HS_VOLUME_MAX_VOXELS in all, HS_ERR_MEMORY if the
 * memory runs out. */
bool hs_volume_init(hs_volume *volume, uint32_t nx, uint32_t ny, uint32_t nz, hs_error *err);

/* Says that the probe was at this face: `probe`, and a `probe_turn` of identity. */
void hs_volume_scanned_from(hs_volume *volume, hs_probe probe);

/* True if it is said where the probe was: a turn that is not all zeros. */
bool hs_probe_is_known(const hs_volume *volume);

/* The axes of who looks from this face, upright, as columns in those of the volume; x is reversed if these
 * are left-handed. */
void hs_probe_axes(const hs_volume *volume, hs_probe face, double out[9]);

/* Frees the voxels and the beams, and zeroes the struct. Safe on a zeroed struct. */
void hs_volume_free(hs_volume *volume);

/* "96 x 96 x 48 voxels of 1.25 x 1.25 x 2.5 mm: 120.0 x 120.0 x 120.0 mm", or that the file does not say. */
void hs_volume_size_words(const hs_volume *volume, char out[HS_SIZE_BYTES]);

/* True if a volume is as large as no prenatal scan, 30 to 400 mm at its widest and 20 mm at least, has voxels
 * of very uneven sides, or its size is not known: then *out says so, and what to do. "The volume is 0.12 mm
 * wide: is its spacing in metres? ..." */
bool hs_volume_doubt(const hs_volume *volume, char out[HS_DOUBT_BYTES]);

/* A question of smartvis/lengths.h as a person reads it, with what to do. True. */
bool hs_spacing_words(const char *question, char *out, size_t bytes);

/* Number of voxels. */
size_t hs_volume_count(const hs_volume *volume);

#define HS_CARTESIAN_AXIS 400u /* voxels along the longest side, at most, if no spacing is given */

/*
 * Makes a volume for `beams`: cubic voxels of `spacing` mm (0: the pitch of the samples, or the box's longest
 * side by HS_CARTESIAN_AXIS if that is more), as many as it takes to hold the box of what was scanned, which
 * lies in their middle. x, y and z are those of the beams, so the probe looks along +z, and the pose has its
 * origin in the array's centre of curvature; how the patient lies is not said. The volume owns
 * `beams` from then on, with beams->corner set; on failure the caller still does. HS_ERR_USAGE: more than
 * HS_VOLUME_MAX_AXIS voxels along an axis; HS_ERR_INPUT: too many in all; HS_ERR_MEMORY.
 */
bool hs_beams_cartesian_init(hs_volume *volume, hs_beams *beams, double spacing, hs_error *err);

/* Fills it from volume->beams. A voxel is linear between the eight samples around its centre, rounded half
 * up, 1 .. 255; where that was not scanned it is 0. All of it is float64, on every processor. */
void hs_beams_cartesian_fill(hs_volume *volume);

/* Fills `count` voxels from voxel `first` on, whole rows of them, into `out`. */
typedef bool (*hs_fill_fn)(void *context, size_t first, size_t count, uint8_t *out, hs_error *err);

/* Fills all voxels piece by piece, on up to `threads` threads; with one of them in order. False with what
 * `fill` said about the first piece that failed. */
bool hs_volume_fill(hs_volume *volume, uint32_t threads, hs_fill_fn fill, void *context, hs_error *err);

/* Keeps as 0 only the zeros that are connected (6-neighbourhood) to the volume's border through zeros, and
 * raises every other zero to 1. Needs a quarter of the volume's size for a while; false (HS_ERR_MEMORY,
 * volume unchanged) if that runs out. */
bool hs_volume_mark_unscanned(hs_volume *volume, hs_error *err);

/* Raises every zero to 1. */
void hs_raise_zeros(uint8_t *voxels, size_t count);

/* Raises every zero of the volume to 1: all of it was scanned. */
void hs_volume_mark_all_scanned(hs_volume *volume);
