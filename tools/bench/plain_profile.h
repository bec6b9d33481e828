/* SPDX-License-Identifier: MIT */
/* Ray profiles in plain C, for a range of rows. */
#ifndef PLAIN_PROFILE_H
#define PLAIN_PROFILE_H

#include "bench/plain_volume.h"

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

#endif
