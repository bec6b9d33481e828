/* SPDX-License-Identifier: MIT */
/* The region that the probe scans. */
#ifndef HS_SCENE_FAN_H
#define HS_SCENE_FAN_H

#include "scene/scene_pass.h"
#include "volume/volume.h"

/* Sets voxels outside the fan to 0. `full` has the field's size. */
void hs_scene_fan(const hs_field *field, const hs_scene_spec *spec, hs_volume *full);

#endif
