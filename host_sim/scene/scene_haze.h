/* SPDX-License-Identifier: MIT */
/* Haze and clutter in the fluid behind the wall. */
#ifndef HS_SCENE_HAZE_H
#define HS_SCENE_HAZE_H

#include "scene/scene_pass.h"

/* Adds the haze to the field's scattered echo, and makes its haze_end. HS_ERR_MEMORY. */
bool hs_scene_haze(hs_field *field, const hs_scene_spec *spec, hs_error *err);

#endif
