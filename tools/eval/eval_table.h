/* SPDX-License-Identifier: MIT */
/*
 * What every start depth does to every viewing ray of a case, so that a setting costs one look-up per ray.
 *
 * With a hard cut (ghost width 0) a ray's termination depth depends on nothing but the step it starts at. The
 * table is made by the renderer itself: one picture per start step, each from a depthmap of one constant. The
 * evaluation picture has one pixel per ray of the low-resolution map, so the renderer's interpolation of the
 * map meets its pixel centres and changes nothing.
 */
#ifndef HS_EVAL_TABLE_H
#define HS_EVAL_TABLE_H

#include "loop/loop.h"

#define HS_EVAL_MAX_STEPS 32767u /* errors are 16 bit */
/* Steps: errors beyond it count as "cut" and "left" (docs/evaluation.md). */
#define HS_EVAL_TOLERANCE 2

typedef struct {
    uint32_t width, height; /* of the map and the evaluation picture, pixels */
    uint32_t steps;         /* of a whole ray; the termination depth of a ray that never ends */
    float steps_per_slice;  /* DVR steps of one low-resolution slice */
    uint8_t *label;         /* HS_LABEL_* per pixel */
    float *truth;           /* g: termination depth in the ground truth per pixel, steps */
    float *full;            /* the same in the full volume, unclipped */

    /* The rays of labels 1 and 2 only, those of the sac first. */
    uint32_t count;       /* n of Eq. 4.6 */
    uint32_t first_fetus; /* rays 0 .. first_fetus - 1 are label 1, the rest label 2 */
    uint32_t occluded;    /* rays whose occluder is in the way: full volume's e > HS_EVAL_TOLERANCE */
    uint32_t *pixel;      /* count: y * width + x */
    uint8_t *is_occluded; /* count: 0 or 1 */
    int16_t *error;       /* count rows of steps + 1: e = g - d (Eq. 4.5) of the ray that starts there */
} hs_eval_table;

/* Builds the table for frame 0 of the loop, whose picture must be as large as its map, with step 1 and no
 * ghost. `truth` is the ground truth on the same grid as `full`; `label` has full->nx * full->ny pixels.
 * HS_ERR_USAGE, HS_ERR_INPUT (no pixel of labels 1 and 2), HS_ERR_MEMORY or HS_ERR_DEVICE; the table is
 * zeroed then. */
bool hs_eval_table_build(hs_eval_table *table, hs_loop *loop, const hs_volume *full, const hs_volume *truth,
                         const uint8_t *label, hs_error *err);
void hs_eval_table_free(hs_eval_table *table);

/* The first step that is drawn when the map holds `depth` slices: the renderer's rule (host_sim/render/dvr.h,
 * CLIPPING), in its own precision. */
uint32_t hs_eval_start_step(const hs_eval_table *table, float depth);

#endif
