/* SPDX-License-Identifier: MIT */
/* What judgements add up to over the cases of a site. */
#ifndef SITE_SCORE_H
#define SITE_SCORE_H

#include "judge/wall_judge.h"

/* Sums of wall_judge's scores. Zeroed: none yet. */
typedef struct {
    wall_score sum;
    double worst; /* largest error of a case */
    char worst_name[64];
    uint32_t count;
    uint32_t refused; /* cases that the method does not clip */
    wall_calibration calibration;
} site_score;

void site_score_add(site_score *to, const char *name, const wall_score *score);

/* The means: error in slices of 128; cut and left as shares. */
wall_score site_score_mean(const site_score *score);

/* Prints "error / cut / left, worst case", and with `sure` the confidence's AUC. */
void site_score_print(const site_score *score, bool sure);

/* Prints, for every tenth of the confidence that has at least 100 rays, what it says on average, how many
 * rays are right there and their share of all. */
void site_score_print_calibration(const char *what, const wall_calibration *calibration);

#endif
