/* SPDX-License-Identifier: MIT */
/* Electronic noise. */
#ifndef HS_SCENE_NOISE_H
#define HS_SCENE_NOISE_H

#include "scene/scene_pass.h"

/* Adds noise to the envelope. */
void hs_scene_noise(hs_field *field, const hs_scene_spec *spec);

#endif
