/* SPDX-License-Identifier: MIT */
/*
 * A volume at half its resolution, made on the device once per volume in one pass over its bytes
 * (cl/halve.cl): for the lit look, which smooths it, and for scan conversion, which samples it.
 */
#ifndef HS_HALVED_H
#define HS_HALVED_H

#include "render/host_cl.h"

#define HS_HALVED_BORDER 2 /* empty voxels on every side of `mean` */

typedef struct hs_halved hs_halved;

/* For volumes of n[0] * n[1] * n[2] voxels. `with_mean`: somebody needs `mean`. Takes no memory of the device
 * yet. NULL with HS_ERR_MEMORY. `cl` must outlive it. */
hs_halved *hs_halved_create(const hs_cl *cl, const uint32_t n[3], bool with_mean, hs_error *err);
void hs_halved_destroy(hs_halved *halved);

/* There is another volume: what was made of the last one does not hold any more. */
void hs_halved_expire(hs_halved *halved);

/*
 * A halved voxel stands for 2 x 2 x 2 source voxels; where an axis is odd the last one stands twice. Source
 * index i is (i - 0.5) / 2 here. Buffers are owned by the halved volume; one byte a voxel, x fastest.
 */
typedef struct {
    cl_int4 dims; /* halved voxels, ceil(n / 2); w: HS_HALVED_BORDER */
    /* The mean of all eight, (sum + 4) / 8; HS_HALVED_BORDER voxels of 0 around. NULL without with_mean. */
    cl_mem mean;
    /* The same, 2 at least, where all eight were scanned (> 0); 1 where some were, 0 where none was. */
    cl_mem marked;
} hs_halved_view;

/* Enqueues the halving if this volume has not been halved yet, and takes its memory the first time; does not
 * wait. HS_ERR_DEVICE. */
bool hs_halved_make(hs_halved *halved, cl_mem voxels, hs_halved_view *view, hs_error *err);

#endif
