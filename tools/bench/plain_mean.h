/* SPDX-License-Identifier: MIT */
/* The mean filter in plain C, for a range of rows. */
#ifndef PLAIN_MEAN_H
#define PLAIN_MEAN_H

#include <stddef.h>
#include <stdint.h>

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

#endif
