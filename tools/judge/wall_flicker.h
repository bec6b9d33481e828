/* SPDX-License-Identifier: MIT */
/* How calm a surface is: how far the ends of rays move from frame to frame, beside the truth's. */
#ifndef WALL_FLICKER_H
#define WALL_FLICKER_H

#include "judge/wall_case.h"

/* Mean move of the rays that are labelled in a frame and in the one before, slices of 128; mean of all frames
 * but the first. */
typedef struct {
    double result, truth;
} wall_flicker;

/* Finds the surface of a frame: a depth for each of its rays; 0: nothing is clipped. */
typedef bool wall_surface(void *user, const wall_case *frame, float *depth, hs_error *err);

/* Judges two frames or more with labels, which have as many rays each: HS_ERR_USAGE, HS_ERR_INPUT;
 * HS_ERR_MEMORY; or what `surface` fails with. It is asked for the frames in their order. */
bool wall_flicker_of(const wall_case *frames, uint32_t count, wall_surface *surface, void *user,
                     wall_flicker *out, hs_error *err);

#endif
