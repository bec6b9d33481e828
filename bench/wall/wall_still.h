/* SPDX-License-Identifier: MIT */
/* How calm a surface is: a scene that stands still, with other speckle and particles in every frame. */
#ifndef WALL_STILL_H
#define WALL_STILL_H

#include "wall/wall_case.h"

/* Mean change of the slice at which a labelled ray ends, from one frame to the next, slices of 128. */
typedef struct {
    double result, truth;
} wall_flicker;

/* Eight frames of a scene at 128^3 (surf_case.h) with the seeds from `seed` on. Frames without a surface
 * count as unclipped. */
bool wall_still(const char *scene, uint64_t seed, uint32_t pose, const sv_wall_settings *settings,
                wall_flicker *out, hs_error *err);

#endif
