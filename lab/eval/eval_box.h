/* SPDX-License-Identifier: MIT */
/* How far scan conversion is from what it stands for: the exact mean of the source over every voxel's box. */
#ifndef HS_EVAL_BOX_H
#define HS_EVAL_BOX_H

#include "render/scan_convert.h"

/* Differences from the exact means, in grey levels, over the voxels that are scanned in both. */
typedef struct {
    double mean, p99; /* of the absolute differences */
    double rms;
    size_t voxels;   /* compared */
    size_t disputed; /* scanned in one and not in the other; neither mean counts them */
} hs_box_error;

/*
 * Compares every `every`th voxel (1: all) of a converted volume with the exact mean: that of 12^3 places in
 * its box, each with the value of the source voxel that it lies in (a source in probe geometry: linear
 * between its echoes). Voxels of 0 were not scanned; a box less than half scanned has no mean. `voxels`:
 * width * height * slices bytes, without tiles and padding. HS_ERR_MEMORY.
 */
bool hs_box_error_measure(const hs_volume *source, const hs_camera *camera, const hs_slab_layout *layout,
                          const uint8_t *voxels, uint32_t every, hs_box_error *out, hs_error *err);

#endif
