/* SPDX-License-Identifier: MIT */
/* Structures at the distance from each other that the scene asks for. */
#ifndef HS_SCENE_PLACE_H
#define HS_SCENE_PLACE_H

#include "base/error.h"
#include "scene/scene_spec.h"

/* Moves along the beam what has a gap_mm: first every such fetus, until the fluid between the sac's wall and
 * its skin is that long where it is shortest; then every such occluder, until its far side is that far before
 * the nearest fetus. Below 0 the two overlap by that much. HS_ERR_INPUT if no beam meets both, HS_ERR_MEMORY.
 */
bool hs_scene_place(hs_scene_spec *spec, hs_error *err);

#endif
