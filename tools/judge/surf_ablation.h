/* SPDX-License-Identifier: MIT */
/* What each part of the cost volume is worth: the scalar definition with one thing changed at a time. */
#ifndef SURF_ABLATION_H
#define SURF_ABLATION_H

#include "judge/surf_case.h"

/* Prints the mean e_abs and cut share over the nine cases of a tuned and of an
 * untuned set for every change. */
bool surf_ablation(const char *const *names, uint32_t count, uint32_t n, hs_error *err);

#endif
