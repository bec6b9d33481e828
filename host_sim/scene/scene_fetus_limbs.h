/* SPDX-License-Identifier: MIT */
/* Arms and legs of the fetus. */
#ifndef HS_SCENE_FETUS_LIMBS_H
#define HS_SCENE_FETUS_LIMBS_H

#include "scene/scene_fetus_pose.h"
#include "scene/scene_solid.h"

/* Adds the solids of the limbs; `frame` is that of the body. */
void hs_fetus_limbs(hs_solid_list *list, const hs_solid_frame *frame, const hs_fetus_pose *pose);

#endif
