/* SPDX-License-Identifier: MIT */
/* The two halves of plain_frame: ray profiles and the mean filter, for a range of rows each. */
#ifndef PLAIN_PARTS_H
#define PLAIN_PARTS_H

#include "frame/plain_frame.h"

/* Rays that are walked together. */
enum { PLAIN_BLOCK = 64 };

/* What is known of the rays, in rows of `stride` values, a multiple of PLAIN_BLOCK. */
typedef struct {
    size_t stride;
    uint8_t *maximum, *tissue;
    uint16_t *entry, *exit;         /* slices of the last crossings */
    uint16_t *max_entry, *max_exit; /* the ones that were current at the (first) maximum */
} plain_rays;

/* Profiles of rows y0 .. y1 - 1. Returns their largest intensity. */
uint8_t plain_profile(const plain_volume *volume, uint8_t fluid_level, uint32_t y0, uint32_t y1,
                      const plain_rays *rays);

enum { PLAIN_NEAR, PLAIN_FAR, PLAIN_WEIGHT, PLAIN_PLANES };

/* The mean filter's maps: weight * near end, weight * far end (fixed point), weight. */
typedef struct {
    uint32_t width, height, k, fraction;
    const uint8_t *status;
    uint32_t *sums[2][PLAIN_PLANES]; /* width * height each; a pass reads one set and writes the other */
    float *surface[2];               /* near, far */
} plain_maps;

/* Weights of initial points and of pixels that an earlier pass filled: omega = 0.5. */
enum { PLAIN_INITIAL = 2, PLAIN_FILLED = 1 };

/* Fraction bits with which the largest sum of a window fits 32 bits, and a depth a float's 24. Fewer than
 * PLAIN_MIN_FRACTION are too coarse. */
enum { PLAIN_MIN_FRACTION = 10 };
uint32_t plain_fraction(uint32_t slices, uint32_t k);

/* One end of `count` intervals as the mean filter's first sums: weight * depth, 0 where the interval is
 * empty. */
void plain_weigh_points(size_t count, uint32_t fraction, const uint8_t *restrict status,
                        const uint16_t *restrict end, uint32_t *restrict sum);

/* S(q) = S_f + q (S_n - S_f) for `count` pixels. */
void plain_blend(size_t count, float q, const float *restrict near_surface, const float *restrict far_surface,
                 float *restrict depth);

/* A thread's rows: plain_mean_row_values(maps) values. */
size_t plain_mean_row_values(uint32_t width, uint32_t k);

/* Pass `number` over rows y0 .. y1 - 1. Returns the pixels there that still have no surface. */
uint32_t plain_mean(const plain_maps *maps, uint32_t number, uint32_t y0, uint32_t y1, uint32_t *rows);

#endif
