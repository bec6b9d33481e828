/* SPDX-License-Identifier: MIT */
/* The mean filter behind a pre-filter: between float32 maps and the fixed-point sums of cl/mean/mean.clh. */
#ifndef SV_METHOD_COMMON_CLH
#include "common/method_common.clh"
#endif
#ifndef SV_MEAN_SHARED_H
#include "mean/mean_shared.h"
#endif

/*
 * One pixel per work item, those of the rows' padding included: the sums of the initial points, of 32 or
 * 64 bits (the same buffer under two types). Two planes: near and far depths, none of them negative. One
 * plane, S(q), whose depths may be: max(depth, 0) and max(-depth, 0).
 */
__kernel void mean_load(sv_job job, uint wide, uint planes, __global const float *maps,
                        __global uint *narrow_sums, __global ulong *wide_sums) {
    if (get_global_id(0) >= job.padded_width) return;
    const size_t plane = (size_t)job.padded_width * job.height;
    const size_t i = get_global_id(1) * job.padded_width + get_global_id(0);
    const float depth = maps[i];
    const uint weight = isinf(depth) ? 0 : job.weight_initial;
    const float scale = (float)(1u << job.fraction);
    const float second = planes == 2 ? maps[plane + i] : -depth;
    const ulong above = weight ? convert_ulong_rte(fmax(depth, 0.0f) * scale) * weight : 0;
    const ulong below = weight ? convert_ulong_rte(fmax(second, 0.0f) * scale) * weight : 0;
    if (wide) {
        wide_sums[SV_SUM_NEAR * plane + i] = above;
        wide_sums[SV_SUM_FAR * plane + i] = below;
        wide_sums[SV_SUM_WEIGHT * plane + i] = weight;
    } else {
        narrow_sums[SV_SUM_NEAR * plane + i] = (uint)above;
        narrow_sums[SV_SUM_FAR * plane + i] = (uint)below;
        narrow_sums[SV_SUM_WEIGHT * plane + i] = weight;
    }
}

/* 16 pixels per work item: the difference of both planes in the first, zeros in the second. */
__kernel void mean_store(uint padded_width, uint height, __global float *restrict surfaces) {
    const size_t plane = (size_t)padded_width * height;
    const size_t i = get_global_id(1) * padded_width + get_global_id(0) * SV_LANES;
    vstore16(vload16(0, surfaces + i) - vload16(0, surfaces + plane + i), 0, surfaces + i);
    vstore16((float16)(0.0f), 0, surfaces + plane + i);
}
