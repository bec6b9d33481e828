/* SPDX-License-Identifier: MIT */
/* Ground truth, read from the tissues themselves. */
#ifndef HS_SCENE_TRUTH_H
#define HS_SCENE_TRUTH_H

#include "scene/scene_data.h"
#include "scene/scene_field.h"
#include "scene/scene_spec.h"

/* Label, interval, clipping surface and clipped volume from full.voxels (0 = not scanned) and the
 * field's tissue. Of the spec it reads where the camera stands and how thick the slice is. HS_ERR_MEMORY. */
bool hs_scene_truth(const hs_field *field, const hs_scene_spec *spec, hs_scene_data *data, hs_error *err);

/* Gives every NAN of a map of nx * ny the value of the nearest pixel that has one (chamfer distance); 0 if
 * none has. HS_ERR_MEMORY. */
bool hs_scene_spread(float *map, uint32_t nx, uint32_t ny, hs_error *err);

#endif
