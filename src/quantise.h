/* SPDX-License-Identifier: MIT */
/*
 * How real parameters become the whole numbers that the kernels compute with: grey levels, counts of rays and
 * samples, weights, fixed-point formats, windows. The plugin and the definitions both ask here, so that they
 * cannot disagree. Pure functions, any thread.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* Thresholds this close to a grey level (in levels) count as that level, so that 40 / 255.0 means 40. */
#define SV_LEVEL_SLACK 1e-9

/* Largest integer n with n <= threshold * 255 * substeps: a sample (in 1 / substeps level) lies above the
 * threshold exactly if it is > n. `threshold` 0..1; clamped to 0 .. 255 * substeps. */
uint32_t sv_grey_level(double threshold, uint32_t substeps);

/* Rays that must qualify at least for a share 0..1 of them: rounded up, at least one. */
uint32_t sv_rays_wanted(double fraction, uint32_t rays);

/* Samples of an interval of at least `gap` slices. */
uint32_t sv_gap_samples(double gap, uint32_t substeps);

/* The smallest integer weights with weight_filled / weight_initial = omega, which is rounded to a quarter. */
void sv_fill_weights(double omega, uint32_t *weight_initial, uint32_t *weight_filled);

/* Passes of a k x k window that are enough for any set of points: each reaches k / 2 pixels further in every
 * direction. At least three, so that a fill weight of 0 is seen to reach nothing new. */
uint32_t sv_pass_limit(uint32_t width, uint32_t height, uint32_t k);

/* Fixed-point format of the mean filter's sums. */
typedef struct {
    uint32_t fraction; /* bits of a depth behind the point */
    bool wide;         /* sums need 64 bits */
} sv_fixed;

/* The finest format whose sums over a k x k window cannot overflow. */
sv_fixed sv_fixed_format(uint32_t width, uint32_t height, uint32_t slices, uint32_t k,
                         uint32_t weight_initial);
