/* SPDX-License-Identifier: MIT */
/* Side-lobe haze. */
#ifndef HS_SCENE_SIDE_LOBES_H
#define HS_SCENE_SIDE_LOBES_H

#include "scene/scene_pass.h"

/* Adds haze beside strong reflectors to the envelope. HS_ERR_MEMORY. */
bool hs_scene_side_lobes(hs_field *field, const hs_scene_spec *spec, hs_error *err);

#endif
