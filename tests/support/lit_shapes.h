/* SPDX-License-Identifier: MIT */
/*
 * Bodies whose picture in the lit look is known exactly: a ball, ellipsoids and planes without noise, in
 * volumes of any size over the same 100 mm. They stand free, so that all light arrives and the colour follows
 * from the normal, the depth and the formula of docs/rendering.md.
 */
#ifndef LIT_SHAPES_H
#define LIT_SHAPES_H

#include "render/dvr.h"
#include "support/host_fixture.h"

#define LIT_BINARY  0.0  /* a voxel is in or out, by its centre */
#define LIT_COVERED -1.0 /* a voxel holds the share of it that is in */

/* The body where |axes (p - centre)| <= 1 (an ellipsoid), or a half space: what lies behind a plane. */
typedef struct {
    const char *name;
    bool plane;
    double radius[3];  /* mm, of an ellipsoid */
    double turn;       /* degrees: an ellipsoid about z and x; a plane about y ... */
    double tilt;       /* ... and, a plane, about x */
    double yaw, pitch; /* of the camera */
    double edge;       /* voxels from nothing to all; or LIT_BINARY, LIT_COVERED */
    double level;      /* grey level inside */
    bool scan_face;    /* nothing was scanned outside; else there is fluid */
} lit_shape;

enum { LIT_SHAPES = 18 };
extern const lit_shape lit_shapes[LIT_SHAPES];

/* How a picture of 256 x 256 differs from the analytic one where the surface is seen at less than 75
 * degrees. */
typedef struct {
    double rms;  /* difference, over the mean brightness */
    double mean; /* brightness, 0 .. 1 */
    size_t pixels;
} lit_difference;

lit_difference lit_shape_measure(const hs_cl *cl, const lit_shape *shape, uint32_t size);

/* The brightness (mean of red, green and blue, 0 .. 1) of a surface with this normal at depth t (0 .. 1) of
 * the box, in all light: docs/rendering.md. Normals are in camera coordinates. `echo`: of a cut, the
 * intensity that shows, 0 .. 1; of skin -1. */
double lit_brightness(const hs_dvr_settings *s, const double normal[3], double t, double echo);

#endif
