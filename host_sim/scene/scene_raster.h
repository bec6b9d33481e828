/* SPDX-License-Identifier: MIT */
/* Solids to voxels. */
#ifndef HS_SCENE_RASTER_H
#define HS_SCENE_RASTER_H

#include "scene/scene_pass.h"
#include "scene/scene_solid.h"

#define HS_SCENE_MAX_SOLIDS 4096u

/* Sets the field's tissue, surface and bone. Sorts the list by part. False with HS_ERR_MEMORY, or if there
 * are more than HS_SCENE_MAX_SOLIDS solids. */
bool hs_scene_raster(hs_field *field, const hs_scene_spec *spec, hs_solid_list *solids, hs_error *err);

#endif
