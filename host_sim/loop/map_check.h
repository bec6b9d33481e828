/* SPDX-License-Identifier: MIT */
#pragma once

#include "render/host_kernels.h"

/* Whether the values of a map that a plugin wrote may be used: counted on the device, in the order of the
 * queue, with no wait of its own. Zeroed: nothing to free. */
typedef struct {
    const hs_cl *cl;
    cl_kernel kernel;
    cl_mem wrong;
    cl_int count; /* wrong values of the last map; valid when the queue has run */
    uint32_t width;
    size_t rows;
} hs_map_check;

/* For maps of float32, width * rows values without a gap. HS_ERR_DEVICE. */
bool hs_map_check_create(hs_map_check *check, const hs_cl *cl, uint32_t width, uint32_t rows, hs_error *err);
void hs_map_check_destroy(hs_map_check *check);

/* Enqueues the count of values that are not in low .. high; NaN is not. */
bool hs_map_check_enqueue(hs_map_check *check, cl_mem map, float low, float high, hs_error *err);
