/* SPDX-License-Identifier: MIT */
/* What a sequence says about one of its volumes beside the voxels, as PLUS and 3D Slicer write it. */
#ifndef HS_FRAME_FIELDS_H
#define HS_FRAME_FIELDS_H

#include <stdbool.h>
#include <stdint.h>

#define HS_FRAME_TRANSFORMS 8u /* of one volume */

/* Where something was while the volume was scanned. */
typedef struct {
    char name[48];     /* "ImageToReference": letters, digits and _ */
    double matrix[16]; /* row-major, mm; the last row is 0 0 0 1. The identity if only a status was given */
    char status[24];   /* "OK", or why it does not hold, in capitals */
} hs_frame_transform;

/* Zeroed: nothing is said. */
typedef struct {
    bool invalid;  /* the image is none */
    bool has_time; /* `time` is given */
    double time;   /* s, by the scanner's clock */
    uint32_t transform_count;
    hs_frame_transform transforms[HS_FRAME_TRANSFORMS];
} hs_frame_fields;

#endif
