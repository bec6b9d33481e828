/* SPDX-License-Identifier: MIT */
/* Reverberation bands. */
#ifndef HS_SCENE_REVERBERATION_H
#define HS_SCENE_REVERBERATION_H

#include "scene/scene_pass.h"

/* Adds interface echoes behind pairs of parallel reflectors. */
void hs_scene_reverberation(hs_field *field, const hs_scene_spec *spec);

#endif
