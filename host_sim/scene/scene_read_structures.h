/* SPDX-License-Identifier: MIT */
/* The structures of a scene file (docs/scenes.md has their fields). */
#ifndef HS_SCENE_READ_STRUCTURES_H
#define HS_SCENE_READ_STRUCTURES_H

#include "scene/scene_json.h"
#include "scene/scene_spec.h"

/* Reads the array "structures". HS_ERR_INPUT names file, line and field. */
bool hs_scene_read_structures(const hs_json *array, hs_scene_spec *spec);

#endif
