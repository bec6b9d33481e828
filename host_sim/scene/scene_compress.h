/* SPDX-License-Identifier: MIT */
/* The received envelope to grey levels. */
#ifndef HS_SCENE_COMPRESS_H
#define HS_SCENE_COMPRESS_H

#include "scene/scene_pass.h"
#include "volume/volume.h"

/* Scattered and interface echo to the envelope without speckle: their powers are added. */
void hs_scene_add_powers(hs_field *field);

/* Log compression: grey = 255 (1 + (L + gain) / range), 1 .. 255. `full` has the field's size. */
void hs_scene_compress(const hs_field *field, const hs_scene_spec *spec, hs_volume *full);

#endif
