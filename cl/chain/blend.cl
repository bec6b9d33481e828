/* SPDX-License-Identifier: MIT */
/* S(q) = S_f + q (S_n - S_f) (spec 4): the depthmap from the two surfaces, one multiply-add per pixel. */
#ifndef SV_SHARED_H
#include "common/sv_shared.h"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* Row y of the depthmap; rows of `depth` have no padding. */
static void blend_row(__global const float *surfaces, uint width, uint padded_width, uint height, uint y,
                      float q, __global float *depth) {
    __global const float *near = surfaces + (size_t)y * padded_width;
    __global const float *far = near + (size_t)padded_width * height;
    __global float *out = depth + (size_t)y * width;
    uint x = 0;
    for (; x + SV_LANES <= width; x += SV_LANES) {
        const float16 f = vload16(0, far + x);
        vstore16(f + q * (vload16(0, near + x) - f), 0, out + x);
    }
    for (; x < width; x++) out[x] = far[x] + q * (near[x] - far[x]);
}

__kernel void blend(__global const float *restrict surfaces, uint width, uint padded_width, uint height,
                    float q, __global float *restrict depth, ulong depth_offset) {
    const uint y = (uint)get_global_id(0);
    blend_row(surfaces, width, padded_width, height, y, q, depth + depth_offset);
}
