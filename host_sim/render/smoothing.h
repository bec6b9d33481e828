/* SPDX-License-Identifier: MIT */
/* Smoothing of a volume of bytes on the device, twice with the weights 1, 2, 1 along every axis (kernel
 * lit_smooth in cl/lit_volume.cl). */
#ifndef HS_SMOOTHING_H
#define HS_SMOOTHING_H

#include "render/host_cl.h"

/* Zeroed but for `cl`: no memory taken yet. `cl` must outlive it. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    cl_mem between; /* after the first smoothing */
} hs_smoothing;

/* Enqueues the smoothing of dims.xyz voxels (one byte each, x fastest), 1028 in x at most, whose outermost
 * ones become 0; does not wait. `to` may be `from`. Takes its memory the first time, for these dims.
 * HS_ERR_DEVICE. */
bool hs_smoothing_run(hs_smoothing *smoothing, cl_mem from, cl_mem to, cl_int4 dims, hs_error *err);
void hs_smoothing_free(hs_smoothing *smoothing);

#endif
