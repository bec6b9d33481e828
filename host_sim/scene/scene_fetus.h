/* SPDX-License-Identifier: MIT */
/* The fetus as smooth-blended solids in a pose. */
#ifndef HS_SCENE_FETUS_H
#define HS_SCENE_FETUS_H

#include "scene/scene_solid.h"

/*
 * The fetal frame, in mm at scale 1 (crown to rump 90 mm, about 14 weeks): x to the fetus' left, which is the
 * viewer's right when it looks at the viewer; y from crown to rump; z from the face to the back. At rotation
 * 0, 0, 0 it stands upright and faces the probe. Index 0 is its own right side, 1 its left.
 */
typedef struct {
    float elbow[2][3], hand[2][3], knee[2][3], ankle[2][3];
    float head_turn_deg[3]; /* of the head about the neck: nod, turn, tilt */
} hs_fetus_pose;

/* Arms before the chest, legs drawn up and crossed. */
extern const hs_fetus_pose hs_fetus_resting;

/* Adds skin, carved and bone solids. */
void hs_fetus_solids(hs_solid_list *list, const hs_solid_frame *frame, const hs_fetus_pose *pose);
/* Its parts. */
void hs_fetus_head(hs_solid_list *list, const hs_solid_frame *frame);
void hs_fetus_limbs(hs_solid_list *list, const hs_solid_frame *frame, const hs_fetus_pose *pose);
/* The frame of the head, turned about the neck. */
void hs_fetus_head_frame(const hs_solid_frame *body, const float turn_deg[3], hs_solid_frame *head);

/* The middle surface of the skull as an ellipsoid in the scene. */
void hs_fetus_skull(const hs_solid_frame *head, hs_solid *skull);

#endif
