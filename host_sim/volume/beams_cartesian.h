/* SPDX-License-Identifier: MIT */
/* The Cartesian copy of a volume in probe geometry: what the renderer samples. */
#ifndef HS_BEAMS_CARTESIAN_H
#define HS_BEAMS_CARTESIAN_H

#include "volume/volume.h"

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

#endif
