/* SPDX-License-Identifier: MIT */
/* Initial points of a scene, to judge whether it poses its problem; the plugin is not asked. */
#ifndef HS_SCENE_POINTS_H
#define HS_SCENE_POINTS_H

#include "scene/scene_data.h"

enum { HS_POINT_NONE = 0, HS_POINT_WRONG = 1, HS_POINT_RIGHT = 2 };

typedef struct {
    uint32_t width, height; /* a third of the scene's */
    uint8_t *kind;          /* HS_POINT_*, width * height, owned */
    uint32_t right, wrong;
    uint8_t maximum; /* of the low-resolution volume */
} hs_scene_points;

/*
 * The rule of thesis 3.2 on the volume's means over 3^3 voxels: T_L = 40.5 / 255, and on rays whose maximum
 * is within 0.24 of the volume's, the last fluid interval before the maximum. A point stands in the
 * interval's middle; it is right if that lies in the scene's admissible interval, give or take one
 * low-resolution slice. HS_ERR_MEMORY.
 */
bool hs_scene_points_find(const hs_scene_data *data, hs_scene_points *out, hs_error *err);
void hs_scene_points_free(hs_scene_points *points);

#endif
