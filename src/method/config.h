/* SPDX-License-Identifier: MIT */
/* What stays the same from frame to frame; from sv_format and the parameters that need reactivation. */
#ifndef SV_CONFIG_H
#define SV_CONFIG_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint32_t width, height, slices, max_slab_slices;
    uint32_t tiles_x, tile_w, tile_h, row_pitch; /* row_pitch of the texture as the kernels read it */
    uint32_t carrier;
    int32_t padding;  /* SV_NO_PADDING: none */
    bool ranged;      /* every frame brings the scanned range of every ray */
    float spacing[3]; /* mm between voxels; never 0: where the host does not know it, assumed */
    uint32_t substeps;
    uint32_t strategy;          /* SV_STRATEGY_*; AUTO is resolved by sv_pipeline_create */
    uint32_t method, prefilter; /* SV_METHOD_*, SV_PREFILTER_* */
    uint32_t merge_grid, spline_grid;
    uint32_t reduction; /* pixels along a side of the cells that the method works on; 1: pixels */
    bool half_sums;     /* mean filter: planes of 16 bits between passes */
    bool float32;       /* the solvers do without float64 even where the device has it */
    const void *host_memory;
    uint64_t host_memory_bytes;
} sv_config;

#endif
