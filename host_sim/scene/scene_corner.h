/* SPDX-License-Identifier: MIT */
/* A corner of the image where the probe has little contact. */
#ifndef HS_SCENE_CORNER_H
#define HS_SCENE_CORNER_H

#include "scene/scene_pass.h"

/* Takes the loss off the field's scattered and interface echo. */
void hs_scene_dark_corner(hs_field *field, const hs_scene_spec *spec);

#endif
