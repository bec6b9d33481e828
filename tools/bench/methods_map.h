/* SPDX-License-Identifier: MIT */
/* Initial points for the reconstruction methods: a shallow volume, and the
 * points that the definition finds. */
#ifndef METHODS_MAP_H
#define METHODS_MAP_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

enum { METHODS_SLICES = 64 };

/* n x n rays of METHODS_SLICES voxels, slice by slice. All arrays are owned. Interval ends in slices; 0 where
 * there is no interval. */
typedef struct {
    uint32_t n, points;
    size_t bytes; /* of the volume */
    uint8_t *voxels, *status;
    uint16_t *near_end, *far_end;
} methods_map;

/* The benchmark's layered volume (bench_slabs.h): 3 % of the rays are points, in patches. HS_ERR_MEMORY. */
bool methods_map_bones(methods_map *map, uint32_t n, hs_error *err);

/* `count` points, 1 .. n * n / 2, anywhere in the map, between two wavy layers. HS_ERR_MEMORY. */
bool methods_map_scattered(methods_map *map, uint32_t n, uint32_t count, hs_error *err);

void methods_map_free(methods_map *map);

/* The points as text, a line "x y near far" each. HS_ERR_OUTPUT names the path. */
bool methods_map_write(const methods_map *map, const char *path, hs_error *err);

#endif
