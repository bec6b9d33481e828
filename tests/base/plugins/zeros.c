/* SPDX-License-Identifier: MIT */
/* A whole plugin whose depthmap is always zero: it clips nothing, so an evaluation must find exactly the
 * errors of the unclipped volume. It has no parameter at all. */
#include "smartvis/author.h"

#include <CL/cl.h>

static sv_status finish(sva *a, float *depth) { /* NOLINT(readability-non-const-parameter) */
    return SV_OK;
}

static sv_status output(sva *a, const sv_result *result) {
    static const float nothing = 0.0f;
    const size_t rays = sva_rays(a);
    if (result->status) memset(result->status, SV_POINT_NONE, rays);
    if (result->stats) {
        const sv_stats stats = {.size = result->stats->size, .outcome = SV_OK, .rays = (uint32_t)rays};
        *result->stats = stats;
    }
    if (!result->depth_object) return sva_error(a, SV_ERR_ARGUMENT, "depth_object is NULL");
    const cl_int code = clEnqueueFillBuffer(a->format.queue, result->depth_object, &nothing, sizeof nothing,
                                            result->depth_offset, rays * sizeof nothing, 0, NULL, NULL);
    return code == CL_SUCCESS ? SV_OK : sva_error(a, SV_ERR_OPENCL, "clEnqueueFillBuffer: %d", code);
}

static const sv_descriptor descriptor = SVA_DESCRIPTOR_OF(
    "org.smartvis.test.zeros", "Zeros", "SmartVis tests", "1.0.0",
    "A map of zeros, whatever the volume holds.", 0,
    SV_BIT(SV_CARRIER_HOST) | SV_BIT(SV_CARRIER_BUFFER) | SV_BIT(SV_CARRIER_IMAGE), SV_QUEUE_HOST);

static const sva_method method = {.descriptor = &descriptor, .finish = finish, .output = output};
SVA_ENTRY(method);
