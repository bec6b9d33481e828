/* SPDX-License-Identifier: MIT */
/* The artefacts of a scene file (docs/scenes.md has their fields). */
#ifndef HS_SCENE_READ_ARTEFACTS_H
#define HS_SCENE_READ_ARTEFACTS_H

#include "scene/scene_json.h"
#include "scene/scene_spec.h"

/* What the optional fields hold that a file does not name. */
void hs_scene_artefact_defaults(hs_scene_spec *spec);

/* Reads the array "artefacts". HS_ERR_INPUT names file, line and field. */
bool hs_scene_read_artefacts(const hs_json *array, hs_scene_spec *spec);

#endif
