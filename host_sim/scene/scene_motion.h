/* SPDX-License-Identifier: MIT */
/* Motion of a scene. */
#ifndef HS_SCENE_MOTION_H
#define HS_SCENE_MOTION_H

#include "scene/scene_spec.h"

/* Moves the scene to where it stands at `frame`. */
void hs_scene_move(hs_scene_spec *spec, uint32_t frame);

#endif
