/* SPDX-License-Identifier: MIT */
/*
 * The yardsticks: what a careful C programmer gets from two threads and the compiler's vectoriser, -O3
 * -march=native, without intrinsics. For the benchmark only; it shares no code with the plugin.
 */
/* The volume they read. */
#ifndef PLAIN_VOLUME_H
#define PLAIN_VOLUME_H

#include <stddef.h>
#include <stdint.h>

/* A volume as slices in tiles: voxel (x, y, z) is slice[z][y * pitch + x]. Not owned. After every row
 * PLAIN_READ_AHEAD bytes more may be read; they do not matter. */
enum { PLAIN_READ_AHEAD = 63 };
typedef struct {
    uint32_t width, height, slices;
    const uint8_t *const *slice;
    size_t pitch; /* bytes */
} plain_volume;

#endif
