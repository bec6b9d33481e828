/* SPDX-License-Identifier: MIT */
/* Edge (refraction) shadows. */
#ifndef HS_SCENE_EDGE_H
#define HS_SCENE_EDGE_H

#include "scene/scene_pass.h"

/* Lowers the levels of scattered and interface echo behind edges. */
void hs_scene_edge_shadow(hs_field *field, const hs_scene_spec *spec);

#endif
