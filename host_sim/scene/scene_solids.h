/* SPDX-License-Identifier: MIT */
/* The structures of a scene as solids. */
#ifndef HS_SCENE_SOLIDS_H
#define HS_SCENE_SOLIDS_H

#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

/* Adds the solids of all structures but sac and layers. The places of particles
 * come from `seed`. HS_ERR_MEMORY. */
bool hs_scene_solids(const hs_scene_spec *spec, uint64_t seed, hs_solid_list *list, hs_error *err);

/* Whether a structure has an echo or an edge of its own: its voxels then carry a style. */
bool hs_scene_style(const hs_structure *structure);

/* The scene's fetus of that number, from 0; NULL if there are fewer. Borrowed. */
const hs_fetus_spec *hs_scene_fetus(const hs_scene_spec *spec, uint32_t number);

#endif
