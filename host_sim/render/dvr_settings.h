/* SPDX-License-Identifier: MIT */
/* How the renderer draws, and where its rays start. */
#pragma once

#include "render/host_kernels.h"

#include <math.h>

/* HS_LOOK_THESIS: Eq. 3.22 - 3.24 (dvr.h), what all measures use. HS_LOOK_LIT: a smooth surface in light
 * (docs/rendering.md), for pictures. */
typedef enum { HS_LOOK_THESIS, HS_LOOK_LIT, HS_LOOK_COUNT } hs_look;

/* "thesis", "lit": for command lines and files. */
const char *hs_look_key(hs_look look);

typedef struct {
    uint32_t width, height; /* pixels of the picture, e.g. 512 x 512 */
    float threshold_low;    /* T_L, 0..1: opacity 0 here and below */
    float threshold_high;   /* T_H, 0..1, > T_L: opacity 1 here and above, linear in between */
    float step;             /* from sample to sample, in source slices as above */
    float termination;      /* stop a ray when its opacity reaches this, 0.001..1 (0.95); above 1: never */
    float ghost_offset;     /* s, in steps: opacity factor 0 up to d_p - s ... */
    float ghost_width;      /* w, in steps: ... rising linearly to 1 at d_p - s + w; 0: a hard cut */
    float ghost_doubt;      /* g, 0..HS_DVR_MAX_DOUBT: where nothing is sure the window is longer by g w */
    float skin[3];          /* colour of intensity 1 */
    float exposure;         /* gain of the finished colour, 0.1..10, saturating; 1 is the formula itself */
    bool skip_empty;        /* leap over transparent bricks: the same picture, sooner; off to measure only */
    hs_look look;           /* of the picture; ends of rays are the thesis' in either */
    float light[2];         /* lit only: where the lamp is, degrees: azimuth -180..180, elevation -90..90 */
} hs_dvr_settings;

#define HS_DVR_MAX_DOUBT   16.0f
#define HS_DVR_MAX_PICTURE 8192       /* pixels a side */
#define HS_DVR_MAX_STEPS   (1u << 22) /* kernels count steps in float */

/* The defaults of spec 9 (T_L 40.5/255, T_H 0.45, one slice, 0.95), 512 x 512, s = w = 0, g = 2; the thesis'
 * look, the lamp to the left above the viewer. */
void hs_dvr_defaults(hs_dvr_settings *settings);

/* The opacity of a sample of a grey level, 0..1 (Eq. 3.22). */
static inline float hs_dvr_opacity(const hs_dvr_settings *settings, uint8_t level) {
    const float low = settings->threshold_low, range = settings->threshold_high - low;
    return fminf(fmaxf(((float)level / 255.0f - low) / range, 0.0f), 1.0f);
}

/* HS_ERR_USAGE names the first setting that is out of range, its value and its range. */
bool hs_dvr_check_settings(const hs_dvr_settings *settings, hs_error *err);

/* Start depths for the rays: a low-resolution depthmap of width x height float32 in low-resolution
 * slices of a volume of `slices` slices, bilinearly interpolated between pixel centres; <= 0 starts
 * at the front of the box. `depth` NULL renders the full volume. `confidence`, of the same shape,
 * 0 .. 1, may be NULL: all is sure. `share`: the side of the picture's window as a part of the map's side,
 * both around the same middle; 0: the picture shows all of the map. */
typedef struct {
    cl_mem depth, confidence;
    uint32_t width, height, slices;
    float share;
} hs_start_depths;

/* HS_ERR_USAGE or HS_ERR_DEVICE if a size or a buffer cannot be right; NULL is. */
bool hs_dvr_check_start(const hs_start_depths *depths, hs_error *err);
