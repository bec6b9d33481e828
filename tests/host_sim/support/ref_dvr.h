/* SPDX-License-Identifier: MIT */
/*
 * The renderer's definition (host_sim/render/dvr.h, spec 5) in scalar double precision: one ray,
 * one sample after the other, no skipping. Written from the definition; it shares nothing with
 * the kernels but the settings.
 */
#pragma once

#include "render/dvr.h"

#include <stdint.h>

typedef struct {
    const float *depth;      /* NULL: unclipped */
    const float *confidence; /* NULL: all is sure */
    uint32_t width, height, slices;
} ref_depthmap;

typedef struct {
    double rgb[3];      /* 0 .. 255 */
    double termination; /* steps */
    double margin;      /* how close a decision was: see ref_dvr_pixel */
} ref_pixel;

/* Voxel index of normalised box coordinates, straight from the camera's axes. */
void ref_position(const hs_volume *volume, const hs_camera *camera, const double box[3], double out[3]);

/* A voxel inside the volume, 0 .. 255. */
double ref_voxel(const hs_volume *volume, int64_t x, int64_t y, int64_t z);

/* Trilinear; beyond the outer voxel centres the nearest voxel counts. weight(value) is applied to every
 * voxel; NULL: the value itself. */
double ref_linear(const uint8_t *data, const uint32_t n[3], const double position[3],
                  double (*weight)(double));
double ref_trilinear(const hs_volume *volume, const double position[3], double (*weight)(double));

/* One of a map's arrays under a place of the picture, 0 .. 1: bilinear between its pixels' centres, its edges
 * extended. */
double ref_map_value(const ref_depthmap *map, const float *values, double u, double v);

/* Is the position in the volume's box, a thousandth of a voxel larger on every side? *margin becomes the
 * distance to a face, in voxels, if that is smaller. */
bool ref_inside(const hs_volume *volume, const double position[3], double *margin);

/*
 * One pixel. `margin` is the smallest distance of a yes-or-no decision on its way from going the other way:
 * opacity to `termination`, a sample to a face of the volume's box (voxels) or to a hard cut (steps), a start
 * depth to 0.
 */
ref_pixel ref_dvr_pixel(const hs_volume *volume, const hs_camera *camera, const hs_dvr_settings *s,
                        const ref_depthmap *map, uint32_t x, uint32_t y);
