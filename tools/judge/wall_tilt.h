/* SPDX-License-Identifier: MIT */
/* Another pose of a camera before a case whose truth is known: a check on data that nobody made for it. */
#ifndef WALL_TILT_H
#define WALL_TILT_H

#include "judge/wall_case.h"

/* The case as a camera sees it that is turned by `degrees` about x and then about y, around the middle of the
 * volume: as many voxels of the same size; what comes to lie outside of them is lost. A voxel was scanned if
 * all eight around its place were. Rays end where they do in the turned ground truth; a ray's label is that
 * of the ray of `c` that ends in the same place, at most two rays and three slices away, else none. In that
 * truth what hides is removed along the rays of `c`, so turns should be small. False: no memory, and `c` is
 * as it was. */
bool wall_case_tilt(wall_case *c, const double degrees[2], hs_error *err);

#endif
