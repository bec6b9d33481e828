/* SPDX-License-Identifier: MIT */
/* A volume in the geometry of the beams that scanned it: radius, angle in the plane, angle of the sweep. */
#pragma once

#include "core/error.h"

#include <stddef.h>
#include <stdint.h>

/*
 * Sample (i, j, k) is voxels[(k * lines + j) * samples + i], the echo at radius r = start + i * pitch, in the
 * line at theta[j], in the plane at phi[k]. In millimetres, with the origin in the array's centre of
 * curvature, z the depth, and the sweep's axis parallel to x at z = axis, it stands at
 *
 *     q = r cos(theta) - axis;   x = r sin(theta);   y = side * q sin(phi);   z = axis + q cos(phi).
 *
 * `side` is -1, or +1 if the volume is mirrored: files do not say which one is true (docs/kretz.md).
 *
 * Everything between the first and the last sample, line and plane was scanned, and nothing else. Here 0 is a
 * black echo. Samples, lines and planes are two at least. Angles ascend or descend strictly, their first and
 * last are opposite, and they span less than pi; q > 0 everywhere.
 */
typedef struct {
    uint32_t samples, lines, planes;
    double pitch, start; /* mm; pitch > 0, start >= 0 */
    double axis;         /* mm, of either sign */
    double *theta, *phi; /* rad; lines and planes of them, owned */
    bool mirrored;
    uint8_t *voxels; /* samples * lines * planes bytes, owned */
    double
        corner[3]; /* mm: the corner of the Cartesian volume that was made of it (hs_beams_cartesian_init) */
} hs_beams;

/* A copy of the geometry with voxels of its own, which are not filled. NULL: HS_ERR_MEMORY. */
hs_beams *hs_beams_like(const hs_beams *geometry, hs_error *err);

/* Frees everything. NULL is allowed. */
void hs_beams_free(hs_beams *beams);

/* Number of samples of all lines and planes. */
size_t hs_beams_count(const hs_beams *beams);

/* The sign of y to which the sweep turns: -1, or +1 if it is mirrored. */
double hs_beams_side(const hs_beams *beams);

/* "sweep + at -y", or what a mirrored one has: the mark of orientation in captions. Static. */
const char *hs_beams_side_name(const hs_beams *beams);

/* Where sample (i, j, k) stands, in mm from the array's centre of curvature. */
void hs_beams_place(const hs_beams *beams, uint32_t i, uint32_t j, uint32_t k, double place[3]);

/* The smallest box that holds what was scanned. */
void hs_beams_box(const hs_beams *beams, double low[3], double high[3]);

/* True if the steps of a table differ by less than a millionth of one of them. */
bool hs_beams_even(const double *table, uint32_t count);

/*
 * Where a place lies in the voxels, in samples, lines and planes; false if it was not scanned. Places behind
 * the sweep's axis or behind the array, which the tangents alone would take for their mirror images, are not.
 */
bool hs_beams_locate(const hs_beams *beams, const double place[3], double index[3]);

/* The two halves of that, for rows of places with the same y and z. The plane's index (-1: none) and the
 * depth c in the unswept plane; then, with it, sample and line of the place at x. */
double hs_beams_locate_plane(const hs_beams *beams, double y, double z, double *depth);
bool hs_beams_locate_in_plane(const hs_beams *beams, double x, double depth, double index[2]);

/* Linear between the eight samples around an index from hs_beams_locate, 0 .. 255. */
double hs_beams_sample(const hs_beams *beams, const double index[3]);
