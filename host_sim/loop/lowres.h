/* SPDX-License-Identifier: MIT */
/* The grid on which a plugin sees a volume: one for every door, so that all of them get the same bits. */
#pragma once

#include "render/camera.h"

/* Pixels across a box of this extent: cubic voxels of so many pixels if `lowres` is not 0. Else, as a fetus
 * is as large in every file, they are of 1 mm, but no finer than the source and no coarser than three of its
 * voxels. */
uint32_t hs_lowres_across(const hs_volume *volume, uint32_t lowres, double extent);

/* Width, height and slices over the camera's box. HS_ERR_USAGE for a `lowres` above 8192, HS_ERR_INPUT for a
 * volume that would need more pixels than are made unasked. */
bool hs_lowres_size(const hs_volume *volume, uint32_t lowres, const hs_camera *box, uint32_t size[3],
                    hs_error *err);
