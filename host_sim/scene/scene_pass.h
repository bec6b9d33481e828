/* SPDX-License-Identifier: MIT */
/* What a step of a scene works on. */
#ifndef HS_SCENE_PASS_H
#define HS_SCENE_PASS_H

#include "scene/scene_field.h"
#include "scene/scene_spec.h"

/* A loop over the y rows or z slices of a field. Both are borrowed. */
typedef struct {
    hs_field *field;
    const hs_scene_spec *spec;
} hs_pass;

#endif
