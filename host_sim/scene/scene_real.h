/* SPDX-License-Identifier: MIT */
/* A scene of kind "real": occluders before a given volume. */
#ifndef HS_SCENE_REAL_H
#define HS_SCENE_REAL_H

#include "scene/scene_field.h"
#include "volume/volume.h"

/* Moves the volume back until the room before it is `share` (0 .. 1, exclusive) of the whole depth. */
bool hs_scene_real_lead(hs_volume *given, double share, hs_error *err);

/* Keeps occluders only where the given volume is free. */
void hs_scene_real_place(hs_field *field, const hs_volume *given);

/* Given volume and occluders in one. */
void hs_scene_real_combine(hs_field *field, const hs_volume *given, hs_volume *full);

#endif
