/* SPDX-License-Identifier: MIT */
#ifndef SV_REF_VOLUME_H
#define SV_REF_VOLUME_H

#include <stddef.h>
#include <stdint.h>

/* A whole camera-aligned volume: voxel (x, y, z) at voxels[(z * height + y) * width + x]. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices;
    int32_t padding; /* voxels of this value were not scanned; -1: all were */
} sv_ref_volume;

#endif
