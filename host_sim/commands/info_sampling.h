/* SPDX-License-Identifier: MIT */
/* How long sampling takes: in the probe's own grid, and in its Cartesian copy. */
#ifndef HS_INFO_SAMPLING_H
#define HS_INFO_SAMPLING_H

#include "volume/volume.h"

/* Samples the middle of `volume`, which has beams, from an oblique camera at places about a voxel apart, by
 * the kernels of scan conversion: linearly in its Cartesian copy, and linearly in the probe's grid, at the
 * same places.
 * Prints the shortest times of several turns and their ratio. Opens an OpenCL device. HS_ERR_DEVICE or
 * HS_ERR_MEMORY. */
bool hs_info_sampling(const hs_volume *volume, hs_error *err);

#endif
