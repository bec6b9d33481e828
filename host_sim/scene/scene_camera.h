/* SPDX-License-Identifier: MIT */
/* A camera that does not look along the beams. */
#ifndef HS_SCENE_CAMERA_H
#define HS_SCENE_CAMERA_H

#include "scene/scene_pass.h"
#include "scene/scene_solid.h"
#include "volume/volume.h"

/* Whether the scene has such a camera. */
bool hs_scene_camera_turned(const hs_scene_spec *spec);

/* Where the scene has point p of the camera's cube, in mm; p itself without such a camera. */
void hs_scene_camera_point(const hs_scene_spec *spec, const float p[3], float out[3]);

/* Samples the scan again on the camera's voxels, and makes the field's tissue that of the solids there.
 * `full` is a cube of the field's size, and is replaced. HS_ERR_MEMORY. */
bool hs_scene_camera(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_volume *full,
                     hs_error *err);

#endif
