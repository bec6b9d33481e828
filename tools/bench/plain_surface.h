/* SPDX-License-Identifier: MIT */
/* The mean filter alone in plain C, from initial points to S(q), and the memory it cannot do without. */
#ifndef PLAIN_SURFACE_H
#define PLAIN_SURFACE_H

#include "bench/bench_team.h"

#include <stddef.h>
#include <stdint.h>

/* Initial points of a map of width x height pixels: SV_POINT_*, and interval ends in slices. Not owned. */
typedef struct {
    uint32_t width, height, slices;
    const uint8_t *status;
    const uint16_t *near_end, *far_end;
} plain_points;

typedef struct plain_surface plain_surface;

/* `team` and the points must outlive it. k odd. NULL with HS_ERR_MEMORY, or HS_ERR_USAGE if a window's sums
 * do not fit 32 bits with 10 fraction bits. */
plain_surface *plain_surface_create(bench_team *team, const plain_points *points, uint32_t k, hs_error *err);
void plain_surface_destroy(plain_surface *surface);

/* Points to sums, all passes over both ends, S(q) into `depth` (width * height slices). Returns the passes.
 * There must be an initial point. Between bench_team_ready and _rest, as is the next. */
uint32_t plain_surface_run(plain_surface *surface, float q, float *depth);

/* The least that any method moves: reads two float32 maps and writes one, with a multiply-add between. */
void plain_surface_touch(plain_surface *surface, float q, float *depth);

/* ---- parts that the whole frame shares */

/* Fraction bits with which the largest sum of a window fits 32 bits, and a depth a float's 24. Fewer than
 * PLAIN_MIN_FRACTION are too coarse. */
enum { PLAIN_MIN_FRACTION = 10 };
uint32_t plain_fraction(uint32_t slices, uint32_t k);

/* One end of `count` intervals as the mean filter's first sums: weight * depth, 0
 * where the interval is empty. */
void plain_weigh_points(size_t count, uint32_t fraction, const uint8_t *restrict status,
                        const uint16_t *restrict end, uint32_t *restrict sum);

/* S(q) = S_f + q (S_n - S_f) for `count` pixels. */
void plain_blend(size_t count, float q, const float *restrict near_surface, const float *restrict far_surface,
                 float *restrict depth);

#endif
