/* SPDX-License-Identifier: MIT */
/* How good a surface is: Eq. 4.6 of the thesis, how much of the fetus is cut and of occluders is left, and
 * whether the confidence predicts errors. */
#ifndef WALL_JUDGE_H
#define WALL_JUDGE_H

#include "judge/wall_case.h"

/* Bins of the confidence. Most of it is above 0.98, where coarse bins would merge different values. */
#define WALL_BINS 2048

typedef struct {
    double error; /* mean over labelled rays of |end in the result - end in the truth|, slices of 128 */
    double cut;   /* share of the fetus' rays that end more than 2 slices too deep */
    double left;  /* share of the labelled rays that end more than 2 slices too early */
} wall_score;

/* Labelled rays by confidence, right ones (error at most 2 slices) and wrong ones. Scores are added to it. */
typedef struct {
    uint64_t right[WALL_BINS], wrong[WALL_BINS];
} wall_calibration;

/* Slice at which ray `pixel` ends when it starts at a surface of that depth. */
float wall_ray_end(const wall_case *c, const uint8_t *voxels, size_t pixel, float depth);

/* The first slice that is drawn (host_sim's rule for a step of one slice). */
uint32_t wall_first_drawn(float depth, uint32_t nz);

wall_score wall_judge(const wall_case *c, const uint8_t *original, const float *depth,
                      const float *confidence, wall_calibration *calibration);

/* Area under the ROC curve of the confidence as a predictor of wrong rays. */
double wall_auc(const wall_calibration *calibration);

/* Share of right rays among those of confidence low .. high, and the mean confidence there; false if there
 * are less than `least`. */
bool wall_reliability(const wall_calibration *calibration, double low, double high, uint64_t least,
                      double *right, double *mean);

/* Share of all rays that end on tissue and end more than 2 slices deeper when they start at the surface. */
double wall_cut_anywhere(const wall_case *c, const float *depth);

#endif
