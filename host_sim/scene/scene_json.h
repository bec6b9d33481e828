/* SPDX-License-Identifier: MIT */
/* What the readers of a scene file share (docs/scenes.md has the fields). */
#pragma once

#include "core/json_fields.h"
#include "scene/scene_spec.h"

/* An hs_tissue by its name. */
bool hs_scene_read_tissue(const hs_json *value, const hs_json_field *field, void *tissue);

/* The arrays "artefacts" and "structures". HS_ERR_INPUT names file and field. */
bool hs_scene_read_artefacts(const hs_json *array, hs_scene_spec *spec);
bool hs_scene_read_structures(const hs_json *array, hs_scene_spec *spec);
