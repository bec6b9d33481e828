/* SPDX-License-Identifier: MIT */
/* What scan conversion and renderer share about a source volume on the device. Nobody else includes this. */
#ifndef HS_DEVICE_VOLUME_H
#define HS_DEVICE_VOLUME_H

#include "render/scan_convert.h"

/* Sample positions per brick edge (BRICK_SHIFT in cl/base.cl); a brick's maximum covers one voxel more on
 * the far sides, so that it bounds every trilinear sample whose lower corner lies in the brick.
 */
#define HS_BRICK_SHIFT 3

/* Host buffers of a live sequence whose wrapping is remembered. */
#define HS_WRAP_COUNT 8

struct hs_device_volume {
    const hs_cl *cl;
    uint32_t n[3];      /* voxels */
    uint32_t bricks[3]; /* max(1, ceil((n - 1) / brick edge)) */
    double spacing[3];  /* mm */
    cl_mem voxels;      /* n[0] * n[1] * n[2] bytes, x fastest; not owned: one of wrap[] or `copy` */
    cl_mem copy;        /* a device's own memory; NULL while host memory is wrapped */
    cl_mem grid;        /* brick maxima, one byte each, x fastest */
    struct {
        const uint8_t *host;
        cl_mem buffer;
    } wrap[HS_WRAP_COUNT];
    uint32_t wrap_next; /* the oldest wrapping: the next to go */
    cl_kernel build_grid;
};

#endif
