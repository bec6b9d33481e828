/* SPDX-License-Identifier: MIT */
/*
 * Minimum filter over sparse data (spec 4; thesis 3.3, Algorithm 4.4), in passes of a k x k window, columns
 * first. Empty pixels hold INFINITY, which no minimum chooses, so one map is depth and status at once. Its
 * rows have SV_MIN_MARGIN pixels of INFINITY on either side, which are never written: no window needs a range
 * check. A minimum rounds nothing: exact.
 */
#ifndef SV_METHOD_COMMON_CLH
#include "common/method_common.clh"
#endif
#ifndef SV_MINIMUM_SHARED_H
#include "minimum/minimum_shared.h"
#endif

#define EVERY_PASS 0xffffffffu

static size_t margin_stride(uint padded_width) {
    return (size_t)padded_width + 2 * SV_MIN_MARGIN;
}

/* Number of lanes that are set (0 or -1). */
static uint minimum_lanes_set(int16 mask) {
    const int8 a = mask.lo + mask.hi;
    const int4 b = a.lo + a.hi;
    return (uint)(-(b.x + b.y + b.z + b.w));
}

/* True if the pass before left empty pixels (the filter always goes on while it has a point). */
static bool minimum_needed(__global const volatile uint *record, uint number) {
    if (!surface_wanted(record)) return false;
    return number == EVERY_PASS || number == 0 || record[SV_REC_PASS0 + number - 1] > 0;
}

/* One work item per padded row of both maps, at activation: fills them with INFINITY. */
__kernel void minimum_clear(uint padded_width, __global float *restrict a, __global float *restrict b) {
    const size_t row = get_global_id(0) * margin_stride(padded_width);
    for (size_t i = 0; i < margin_stride(padded_width); i += SV_LANES) {
        vstore16((float16)(INFINITY), 0, a + row + i);
        vstore16((float16)(INFINITY), 0, b + row + i);
    }
}

__kernel void minimum_load(uint padded_width, __global const float *restrict maps,
                           __global float *restrict a) {
    const size_t x = get_global_id(0) * SV_LANES, y = get_global_id(1);
    vstore16(vload16(0, maps + y * padded_width + x), 0,
             a + y * margin_stride(padded_width) + SV_MIN_MARGIN + x);
}

__kernel void minimum_columns(uint padded_width, uint height, uint k, uint number,
                              __global const float *restrict a, __global float *restrict b,
                              __global const volatile uint *restrict record) {
    if (!minimum_needed(record, number)) return;
    const size_t stride = margin_stride(padded_width);
    const size_t x = get_global_id(0) * SV_LANES + SV_MIN_MARGIN;
    const uint y = (uint)get_global_id(1), r = k / 2;
    float16 minimum = (float16)(INFINITY);
    for (uint row = y > r ? y - r : 0; row <= min(y + r, height - 1); row++)
        minimum = fmin(minimum, vload16(0, a + row * stride + x));
    vstore16(minimum, 0, b + y * stride + x);
}

__kernel void minimum_rows(uint width, uint padded_width, uint k, uint number,
                           __global const float *restrict b, __global float *restrict a,
                           volatile __global uint *restrict record) {
    if (!minimum_needed(record, number)) return;
    const uint x = (uint)get_global_id(0) * SV_LANES, r = k / 2;
    const size_t i = get_global_id(1) * margin_stride(padded_width) + SV_MIN_MARGIN + x;
    float16 minimum = (float16)(INFINITY);
    for (uint u = 0; u < k; u++) minimum = fmin(minimum, vload16(0, b + i + u - r));
    const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const int16 inside = lane < (int16)((int)(width - x));
    minimum = select((float16)(INFINITY), minimum, inside); /* pixels outside the image stay empty */
    vstore16(minimum, 0, a + i);
    if (number == EVERY_PASS) return;
    const uint unfilled = minimum_lanes_set(inside & isinf(minimum));
    if (unfilled > 0) atomic_add(record + SV_REC_PASS0 + number, unfilled);
}

/* The result: to the surface (empty: 0), or back to the maps, at initial points only. */
__kernel void minimum_store(uint padded_width, uint to_maps, __global const float *restrict a,
                            __global const uchar *restrict status, __global float *restrict out,
                            __global const uint *restrict record) {
    if (!surface_wanted(record)) return;
    const size_t x = get_global_id(0) * SV_LANES, y = get_global_id(1);
    const size_t i = y * padded_width + x;
    const float16 v = vload16(0, a + y * margin_stride(padded_width) + SV_MIN_MARGIN + x);
    const int16 point = convert_int16(vload16(0, status + i)) != (int16)(SV_STATUS_NONE);
    const float16 surface = select(v, (float16)(0.0f), isinf(v));
    vstore16(to_maps ? select((float16)(INFINITY), v, point) : surface, 0, out + i);
}
