/* SPDX-License-Identifier: MIT */
/* Attenuation and time-gain compensation. */
#ifndef HS_SCENE_ATTENUATION_H
#define HS_SCENE_ATTENUATION_H

#include "scene/scene_pass.h"

/* Changes the levels of scattered and interface echo by what the way there and back takes and gives. */
void hs_scene_attenuation(hs_field *field, const hs_scene_spec *spec);

#endif
