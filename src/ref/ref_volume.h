/* SPDX-License-Identifier: MIT */
#pragma once

#include "sv_beams.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A whole camera-aligned volume: voxel (x, y, z) at voxels[(z * height + y) * width + x]. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices;
    int32_t padding;           /* voxels of this value were not scanned; beyond 0 .. 255: all were */
    const sv_scanned *scanned; /* width * height; NULL: the padding alone tells */
} sv_ref_volume;

/* True if slice z of ray `pixel` (y * width + x) was scanned (spec 2). */
static inline bool sv_ref_scanned(const sv_ref_volume *v, size_t pixel, uint32_t z) {
    if (v->scanned && (z < v->scanned[pixel].first || z >= v->scanned[pixel].end)) return false;
    return v->voxels[(size_t)z * v->width * v->height + pixel] != v->padding;
}

/* The volume that method wall reads: laid out alike, z away from the probe. The pointers are borrowed. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices; /* 1 .. 8192 each */
    /* Ray (x, y) was scanned in slices first[y * width + x] .. end[y * width + x] - 1, and not at all if both
     * are equal. Voxels outside that range are not read. Both pointers NULL: everything was scanned. */
    const uint16_t *first, *end;
    /* Distances along x, y and z, 0.05 .. 20. All three 0: they are not known, and the longest side counts as
     * 120 mm. */
    double spacing_mm[3];
    const sv_beams *beams; /* that the volume was scanned with; NULL: not known */
} sv_wall_volume;
