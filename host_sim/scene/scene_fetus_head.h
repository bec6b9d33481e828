/* SPDX-License-Identifier: MIT */
/* The head of the fetus. */
#ifndef HS_SCENE_FETUS_HEAD_H
#define HS_SCENE_FETUS_HEAD_H

#include "scene/scene_solid.h"

/* Adds the solids of the head; `frame` is that of the head (hs_fetus_head_frame). */
void hs_fetus_head(hs_solid_list *list, const hs_solid_frame *frame);

/* The middle surface of the skull as an ellipsoid in the scene. */
void hs_fetus_skull(const hs_solid_frame *head, hs_solid *skull);

#endif
