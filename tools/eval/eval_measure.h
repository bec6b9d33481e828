/* SPDX-License-Identifier: MIT */
/* Quality of a depthmap by the termination depths of its rays (spec 7; thesis 4, Eq. 4.5 - 4.10). */
#ifndef HS_EVAL_MEASURE_H
#define HS_EVAL_MEASURE_H

#include "eval/eval_table.h"

/* Mean errors are in DVR steps. e > 0: the ray ends too early, an occluder is left.
 * e < 0: the fetus is cut. */
typedef enum {
    HS_MEASURE_ABS, /* Eq. 4.6, over labels 1 and 2 */
    HS_MEASURE_POS, /* Eq. 4.8: over the rays with e > 0; 0 if there is none */
    HS_MEASURE_NEG, /* Eq. 4.10: over the rays with e < 0, as an absolute value; 0 if there is none */
    HS_MEASURE_ABS_SAC,
    HS_MEASURE_POS_SAC,
    HS_MEASURE_NEG_SAC,
    HS_MEASURE_ABS_FETUS,
    HS_MEASURE_POS_FETUS,
    HS_MEASURE_NEG_FETUS,
    HS_MEASURE_FETUS_CUT,     /* share of the fetus' rays with e < -HS_EVAL_TOLERANCE, 0 .. 1 */
    HS_MEASURE_OCCLUDER_LEFT, /* share of the occluded rays with e > HS_EVAL_TOLERANCE, 0 .. 1 */
    HS_MEASURE_COUNT
} hs_measure;

/* "e_abs", "e_pos_fetus", ...: the column of the CSV files. */
const char *hs_measure_key(hs_measure measure);

/* All measures of one result. A measure over no ray at all (a label that does not occur) is NAN. */
typedef struct {
    float of[HS_MEASURE_COUNT];
} hs_measures;

#define HS_EVAL_MAX_LINE 64u

/* The results of `count` (1 .. HS_EVAL_MAX_LINE) depthmaps zero + weight[i] * (one - zero): `zero` and `one`
 * are the maps at weight 0 and 1, width * height slices each. `threads` as for hs_thread_count; few
 * look-ups are done on one. */
void hs_eval_measure_line(const hs_eval_table *table, const float *zero, const float *one,
                          const float *weight, uint32_t count, uint32_t threads, hs_measures *out);

/* The result of one depthmap; NULL: of the full volume, unclipped. */
void hs_eval_measure_map(const hs_eval_table *table, const float *map, hs_measures *out);

/* The direct way, from a picture of termination depths in steps: for tests and checks of the table. */
void hs_eval_measure_picture(const hs_eval_table *table, const float *termination, hs_measures *out);

/* Error e per pixel of such a picture, steps; NAN where the label is 0. */
void hs_eval_error_picture(const hs_eval_table *table, const float *termination, float *out);

/* Looks up the termination depths of a depthmap for every pixel of labels 1 and 2. Others get those of the
 * ground truth. */
void hs_eval_look_up(const hs_eval_table *table, const float *map, float *termination);

#endif
