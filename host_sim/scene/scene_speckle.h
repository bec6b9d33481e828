/* SPDX-License-Identifier: MIT */
/* Speckle: scatterers and the point spread of the pulse. */
#ifndef HS_SCENE_SPECKLE_H
#define HS_SCENE_SPECKLE_H

#include "scene/scene_pass.h"

/* Scattered and interface echo to the received envelope. HS_ERR_MEMORY. */
bool hs_scene_speckle(hs_field *field, const hs_scene_spec *spec, hs_error *err);

#endif
