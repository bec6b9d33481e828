/* SPDX-License-Identifier: MIT */
/*
 * Push-pull interpolation (after Gortler et al., The Lumigraph, 1996): a pyramid of weighted means fills the
 * holes from coarser levels. One pixel per work item; a level's planes hold near depth, far depth and weight.
 *
 *   pull, fine to coarse:  W = sum of the weights of 2 x 2 pixels, value = weighted mean, weight = min(W, 1)
 *   push, coarse to fine:  value = weight * value + (1 - weight) * coarser level, linear between its pixels
 */
#ifndef SV_METHOD_COMMON_CLH
#include "common/method_common.clh"
#endif

/* Sizes of a level, its offset in a plane, and the pixels of a plane (all levels). */
typedef struct {
    uint width, height, offset, plane;
} pull_level;

__kernel void pushpull_enter(uint width, uint padded_width, uint height, uint plane,
                             __global const float *maps, __global float *values,
                             __global const uint *record) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= width || !surface_wanted(record)) return;
    const size_t from = (size_t)y * padded_width + x, to = (size_t)y * width + x;
    const float near = maps[from], far = maps[from + (size_t)padded_width * height];
    const bool point = !isinf(near);
    values[to] = point ? near : 0.0f;
    values[plane + to] = point ? far : 0.0f;
    values[2 * (size_t)plane + to] = point ? 1.0f : 0.0f;
}

/* One pixel of `coarse` from its children. */
__kernel void pushpull_pull(pull_level fine, pull_level coarse, uint planes, __global float *values,
                            __global const uint *record) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= coarse.width || !surface_wanted(record)) return;
    __global const float *weights = values + 2 * (size_t)fine.plane;
    const size_t to = coarse.offset + (size_t)y * coarse.width + x;
    float total = 0.0f, sum[2] = {0.0f, 0.0f};
    for (uint v = 2 * y; v < min(2 * y + 2, fine.height); v++)
        for (uint u = 2 * x; u < min(2 * x + 2, fine.width); u++) {
            const size_t from = fine.offset + (size_t)v * fine.width + u;
            total += weights[from];
            for (uint p = 0; p < planes; p++) sum[p] += weights[from] * values[p * (size_t)fine.plane + from];
        }
    for (uint p = 0; p < planes; p++)
        values[p * (size_t)fine.plane + to] = total > 0.0f ? sum[p] / total : 0.0f;
    values[2 * (size_t)fine.plane + to] = fmin(total, 1.0f);
}

/* The coarser level at pixel (x, y) of the finer one: 3/4 of the nearest pixel and 1/4 of the
 * next, each way. */
static float coarse_value(__global const float *coarse, uint width, uint height, uint x, uint y) {
    const uint u0 = x / 2, v0 = y / 2;
    const uint u1 = x % 2 ? min(u0 + 1, width - 1) : u0 - (u0 > 0);
    const uint v1 = y % 2 ? min(v0 + 1, height - 1) : v0 - (v0 > 0);
    const float near_row = 0.75f * coarse[(size_t)v0 * width + u0] + 0.25f * coarse[(size_t)v0 * width + u1];
    const float next_row = 0.75f * coarse[(size_t)v1 * width + u0] + 0.25f * coarse[(size_t)v1 * width + u1];
    return 0.75f * near_row + 0.25f * next_row;
}

__kernel void pushpull_push(pull_level fine, pull_level coarse, uint planes, __global float *values,
                            __global const uint *record) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= fine.width || !surface_wanted(record)) return;
    const size_t i = fine.offset + (size_t)y * fine.width + x;
    const float weight = values[2 * (size_t)fine.plane + i];
    for (uint p = 0; p < planes; p++) {
        __global float *value = values + p * (size_t)fine.plane;
        const float below = coarse_value(value + coarse.offset, coarse.width, coarse.height, x, y);
        value[i] = weight * value[i] + (1.0f - weight) * below;
    }
}

__kernel void pushpull_leave(uint width, uint padded_width, uint height, uint plane, uint planes,
                             __global const float *values, __global float *surfaces,
                             __global const uint *record) {
    const uint x = (uint)get_global_id(0), y = (uint)get_global_id(1);
    if (x >= width || !surface_wanted(record)) return;
    for (uint p = 0; p < planes; p++)
        surfaces[p * (size_t)padded_width * height + (size_t)y * padded_width + x] =
            values[p * (size_t)plane + (size_t)y * width + x];
}
