/* SPDX-License-Identifier: MIT */
/* A bright band at the far bone of the head, with a thin dark interval before it. */
#ifndef HS_SCENE_FAR_BAND_H
#define HS_SCENE_FAR_BAND_H

#include "scene/scene_pass.h"

/* Sets the levels of scattered and interface echo in the band and the interval. */
void hs_scene_far_band(hs_field *field, const hs_scene_spec *spec);

#endif
