/* SPDX-License-Identifier: MIT */
/* Scenes to judge surfaces on: nine cases, each in its own pose or in a shifted
 * one, with their ground truth. */
#ifndef SURF_CASE_H
#define SURF_CASE_H

#include "scene/scene.h"

/* The scene is made at twice the resolution of the volume that the plugin gets; errors are measured there. */
#define SURF_FINE_PER_VOXEL 2

typedef struct {
    uint32_t n;         /* voxels an axis that the plugin gets */
    uint8_t *voxels;    /* n^3: means of 2^3 scanned voxels, 0 where less than half were scanned */
    hs_scene_data fine; /* (2 n)^3 */
    float *truth;       /* (2 n)^2: ray termination depths in the ground truth, in fine slices */
} surf_case;

/* `pose` 0: the scene as its file has it; else fetus, limbs, occluders and sac are shifted (by up to 4 mm),
 * turned (8 degrees) and scaled (4 %), by numbers that `pose` seeds. `frame` of the scene's motion.
 * HS_ERR_INPUT, HS_ERR_OUTPUT, HS_ERR_MEMORY. */
bool surf_case_make(const char *name, uint32_t n, uint64_t seed, uint32_t pose, uint32_t frame,
                    surf_case *out, hs_error *err);
void surf_case_free(surf_case *c);

typedef struct {
    double error; /* e_abs (spec 7, Eq. 4.6) in slices of the plugin's volume, over labels 1 and 2 */
    double cut;   /* share of the fetus' pixels that are cut by more than two fine steps */
} surf_score;

/* A depthmap of n * n float32 slices, drawn by spec 9's defaults from the fine volume. */
surf_score surf_judge(const surf_case *c, const float *depth);

#endif
