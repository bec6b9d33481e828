/* SPDX-License-Identifier: MIT */
/* A box within a volume: what lies outside of it counts as not scanned. */
#pragma once

#include "volume/volume.h"

/* mm along the volume's x, y, z from the centre of its first voxel, both ends included. */
typedef struct {
    bool used; /* else all of the volume counts */
    double low[3], high[3];
} hs_crop;

bool hs_crop_same(const hs_crop *a, const hs_crop *b);

/* HS_ERR_INPUT: no voxel's centre lies in it. */
bool hs_crop_check(const hs_crop *crop, const hs_volume *volume, hs_error *err);

/* Whether the line from `a` to `b`, both in mm as its ends are, meets it. */
bool hs_crop_meets(const hs_crop *crop, const double a[3], const double b[3]);

/* Zeroes those of a byte a voxel whose centre lies outside. */
void hs_crop_apply(const hs_crop *crop, const hs_volume *volume, uint8_t *bytes);
