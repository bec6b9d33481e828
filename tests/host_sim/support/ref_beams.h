/* SPDX-License-Identifier: MIT */
/*
 * Probe geometry in scalar double precision, written from docs/kretz.md. It shares nothing with the host's
 * conversion but the struct that holds the tables.
 */
#pragma once

#include "render/scan_convert.h"
#include "volume/beams.h"

#define REF_BEAMS_CLOSE 2e-4 /* samples, lines or planes: more than float32 places are off */

typedef struct {
    double echo;   /* 0 .. 255; -1: not scanned */
    double margin; /* how far from a border of what was scanned, in samples, lines or planes */
} ref_echo;

/* The echo at a place, in mm from the array's centre of curvature. */
ref_echo ref_beams_at(const hs_beams *beams, const double place[3]);

/* Where sample (i, j, k) stands. */
void ref_beams_place(const hs_beams *beams, uint32_t i, uint32_t j, uint32_t k, double place[3]);

typedef struct {
    int value;    /* 0 .. 255 */
    double mean;  /* before rounding */
    int close;    /* samples within REF_BEAMS_CLOSE of a border of what was scanned */
    bool decided; /* it is scanned, or is not, wherever those fall */
} ref_beams_voxel;

/* Voxel (x, y, z) of the low-resolution volume, with `grid` samples along each axis. */
ref_beams_voxel ref_beams_convert(const hs_volume *volume, const hs_camera *camera,
                                  const hs_slab_layout *layout, const int grid[3], uint32_t x, uint32_t y,
                                  uint32_t z);
