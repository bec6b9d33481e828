/* SPDX-License-Identifier: MIT */
/* The fetus as smooth-blended solids in a pose. */
#ifndef HS_SCENE_FETUS_H
#define HS_SCENE_FETUS_H

#include "scene/scene_fetus_pose.h"
#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

/* Arms before the chest, legs drawn up and crossed. */
extern const hs_fetus_pose hs_fetus_resting;

/* The frame a fetus is described in. */
hs_solid_frame hs_fetus_frame(const hs_fetus_spec *fetus);

/* Adds skin, carved and bone solids. */
void hs_fetus_solids(hs_solid_list *list, const hs_solid_frame *frame, const hs_fetus_pose *pose);

/* The frame of the head, turned about the neck. */
void hs_fetus_head_frame(const hs_solid_frame *body, const float turn_deg[3], hs_solid_frame *head);

#endif
