/* SPDX-License-Identifier: MIT */
/* The pose of the fetus. */
#ifndef HS_SCENE_FETUS_POSE_H
#define HS_SCENE_FETUS_POSE_H

/*
 * The fetal frame, in mm at scale 1 (crown to rump 90 mm, about 14 weeks): x to the fetus' left, which is the
 * viewer's right when it looks at the viewer; y from crown to rump; z from the face to the back. At rotation
 * 0, 0, 0 it stands upright and faces the probe. Index 0 is its own right side, 1 its left.
 */
typedef struct {
    float elbow[2][3], hand[2][3], knee[2][3], ankle[2][3];
    float head_turn_deg[3]; /* of the head about the neck: nod, turn, tilt */
} hs_fetus_pose;

#endif
