/* SPDX-License-Identifier: MIT */
/*
 * The yardsticks: what a careful C programmer gets from two threads and the compiler's vectoriser, -O3
 * -march=native, without intrinsics. For the benchmark only; it shares no code with the plugin.
 */
#pragma once

#include "bench/bench.h"

#include <stddef.h>
#include <stdint.h>

/* ---------------------------------------------------------------------------------------- ray profiles -- */
/* Ray profiles in plain C, for a range of rows. */

/* What is known of the rays, in rows of `stride` values, a multiple of PLAIN_BLOCK. */
typedef struct {
    size_t stride;
    uint8_t *maximum, *tissue;
    uint16_t *entry, *exit;         /* slices of the last crossings */
    uint16_t *max_entry, *max_exit; /* the ones that were current at the (first) maximum */
} plain_rays;

/* ----------------------------------------------------------------------------------------- mean filter -- */
/* The mean filter in plain C, for a range of rows. */

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

/* A thread's rows: plain_mean_row_values(maps) values. */
size_t plain_mean_row_values(uint32_t width, uint32_t k);

/* Pass `number` over rows y0 .. y1 - 1. Returns the pixels there that still have no surface. */
uint32_t plain_mean(const plain_maps *maps, uint32_t number, uint32_t y0, uint32_t y1, uint32_t *rows);

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

/* ----------------------------------------------------------------------------------------------- frame -- */
/* The whole frame in plain C. */

typedef struct {
    uint8_t fluid_level; /* T_L as a grey level: tissue lies above it */
    uint8_t bone_drop;   /* a ray is bone if its maximum is above (maximum of the volume) - bone_drop */
    uint32_t k;          /* window of the mean filter, odd */
    float q;
} plain_settings;

/* The plugin's work: ray profiles, offset threshold, initial points, mean filter of both ends to
 * completion with weights 2 : 1, S(q). All voxels count as scanned. */
typedef struct plain_frame plain_frame;

/* NULL with HS_ERR_MEMORY, or HS_ERR_USAGE if a window's sums do not fit 32 bits with
 * 10 fraction bits. */
plain_frame *plain_frame_create(uint32_t width, uint32_t height, uint32_t slices,
                                const plain_settings *settings, hs_error *err);
void plain_frame_destroy(plain_frame *frame);

/* One frame, by two threads, and its milliseconds. depth: width * height slices; status: width * height
 * bytes, SV_POINT_*. HS_ERR_MEMORY. */
bool plain_frame_run(plain_frame *frame, const plain_volume *volume, float *depth, uint8_t *status,
                     double *ms, hs_error *err);
