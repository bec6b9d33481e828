/* SPDX-License-Identifier: MIT */
/* What the tissues send back before anything happens to it on the way. */
#ifndef HS_SCENE_ECHO_H
#define HS_SCENE_ECHO_H

#include "scene/scene_pass.h"

/* Sets the levels of scattered and interface echo. */
void hs_scene_echo(hs_field *field, const hs_scene_spec *spec);

#endif
