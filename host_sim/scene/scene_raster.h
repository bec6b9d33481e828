/* SPDX-License-Identifier: MIT */
/* Solids to voxels. */
#ifndef HS_SCENE_RASTER_H
#define HS_SCENE_RASTER_H

#include "scene/scene_pass.h"
#include "scene/scene_solid.h"

/* Sets the field's tissue, surface and bone, and style and share if it has them. Sorts the list by part.
 * False with HS_ERR_MEMORY, or if there are more than HS_SCENE_MAX_SOLIDS solids. */
bool hs_scene_raster(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err);

/* The same for voxels of a cube that is turned around its middle: the rows of `turn` are its axes in the
 * scene. */
bool hs_scene_raster_turned(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids,
                            const float turn[9], hs_error *err);

#endif
