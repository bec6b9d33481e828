/* SPDX-License-Identifier: MIT */
/* The kernels around a method (src/method/method.h): the depths of the initial points, and the frame's
 * record. */
#ifndef SV_RECORD_CLH
#include "common/record.clh"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* One work item: resets the outcome of an earlier run; the points stay. */
__kernel void chain_begin(uint pass_limit, __global uint *restrict record) {
    record[SV_REC_PASSES] = 0;
    record[SV_REC_UNFILLED] = record[SV_REC_RAYS];
    record[SV_REC_OUTCOME] = SV_OUTCOME_NO_SURFACE;
    for (uint pass = 0; pass < pass_limit; pass++) record[SV_REC_PASS0 + pass] = 0;
}

/*
 * 16 pixels per work item: near and far depth in slices at the initial points, INFINITY elsewhere. Blended:
 * S(q) in the first plane, the second is not used.
 */
__kernel void chain_gather(uint padded_width, uint height, __global const ushort *restrict state16,
                           __global const uchar *restrict status, uint blended, float q,
                           __global float *restrict maps) {
    const size_t plane = (size_t)padded_width * height;
    const size_t i = get_global_id(1) * padded_width + get_global_id(0) * SV_LANES;
    const int16 code = convert_int16(vload16(0, status + i));
    const int16 open = code == (int16)(SV_STATUS_INITIAL);
    const int16 none = code == (int16)(SV_STATUS_NONE);
    const float16 per_slice = (float16)((float)SV_SUBSTEPS);
    const float16 zero = (float16)(0.0f), empty = (float16)(INFINITY);
    const float16 exit = convert_float16(vload16(0, state16 + SV_STATE_MAX_EXIT * plane + i)) / per_slice;
    const float16 entry = convert_float16(vload16(0, state16 + SV_STATE_MAX_ENTRY * plane + i)) / per_slice;
    float16 near = select(zero, exit, open);
    const float16 far = select(zero, entry, open);
    if (blended) near = far + q * (near - far);
    vstore16(select(near, empty, none), 0, maps + i);
    vstore16(select(far, empty, none), 0, maps + plane + i);
}

/*
 * Reduced resolution: a cell of reduction x reduction pixels per work item, those of the rows' padding
 * included. Near and far depth of its points' mean (`minimum`: of the one nearest to the viewer); a cell
 * without points holds INFINITY.
 */
__kernel void chain_cells(uint width, uint padded_width, uint height, __global const ushort *restrict state16,
                          __global const uchar *restrict status, uint blended, float q, uint minimum,
                          uint reduction, uint cells_padded, uint cells_height, __global float *restrict maps,
                          __global uchar *restrict cell_status) {
    const uint u = (uint)get_global_id(0), v = (uint)get_global_id(1);
    if (u >= cells_padded) return;
    const size_t plane = (size_t)padded_width * height, cells = (size_t)cells_padded * cells_height;
    float count = 0.0f, sum_near = 0.0f, sum_far = 0.0f, smallest = INFINITY;
    for (uint y = v * reduction; y < min((v + 1) * reduction, height); y++)
        for (uint x = u * reduction; x < min((u + 1) * reduction, width); x++) {
            const size_t i = (size_t)y * padded_width + x;
            if (status[i] == SV_STATUS_NONE) continue;
            const bool open = status[i] == SV_STATUS_INITIAL;
            const float exit = open ? (float)state16[SV_STATE_MAX_EXIT * plane + i] : 0.0f;
            const float entry = open ? (float)state16[SV_STATE_MAX_ENTRY * plane + i] : 0.0f;
            const float near = exit / (float)SV_SUBSTEPS, far = entry / (float)SV_SUBSTEPS;
            count += 1.0f;
            sum_near += blended ? far + q * (near - far) : near;
            sum_far += far;
            smallest = fmin(smallest, far + q * (near - far));
        }
    const size_t i = (size_t)v * cells_padded + u;
    const bool none = count == 0.0f;
    maps[i] = none ? INFINITY : minimum ? smallest : sum_near / count;
    maps[cells + i] = none ? INFINITY : sum_far / count;
    cell_status[i] = none ? SV_STATUS_NONE : SV_STATUS_INITIAL;
}

/* A cell per work item: its pixels, bilinear between the cells' centres, constant beyond the outermost. */
__kernel void chain_spread(uint width, uint padded_width, uint height, uint reduction, uint cells_width,
                           uint cells_padded, uint cells_height, uint planes,
                           __global const float *restrict cells, __global float *restrict surfaces,
                           __global const uint *restrict record) {
    const uint u = (uint)get_global_id(0), v = (uint)get_global_id(1);
    if (u >= cells_width || !surface_wanted(record)) return;
    const uint left = u - (u > 0), right = min(u + 1, cells_width - 1);
    const uint up = v - (v > 0), down = min(v + 1, cells_height - 1);
    for (uint p = 0; p < planes; p++) {
        __global const float *s = cells + p * (size_t)cells_padded * cells_height;
        __global float *to = surfaces + p * (size_t)padded_width * height;
        for (uint j = 0; j < reduction && v * reduction + j < height; j++) {
            /* from the cell's centre, in cells */
            const float fy = (float)(2 * (int)j + 1 - (int)reduction) / (float)(2 * reduction);
            __global const float *row = s + v * cells_padded;
            __global const float *next = s + (fy < 0.0f ? up : down) * cells_padded;
            const float ty = fabs(fy);
            const float a = row[left] + ty * (next[left] - row[left]);
            const float b = row[u] + ty * (next[u] - row[u]);
            const float c = row[right] + ty * (next[right] - row[right]);
            for (uint i = 0; i < reduction && u * reduction + i < width; i++) {
                const float fx = (float)(2 * (int)i + 1 - (int)reduction) / (float)(2 * reduction);
                to[(size_t)(v * reduction + j) * padded_width + u * reduction + i] =
                    b + fabs(fx) * ((fx < 0.0f ? a : c) - b);
            }
        }
    }
}

/* One work item: notes that every pixel has its surface, if there is one. */
__kernel void chain_done(uint passes, __global uint *restrict record) {
    if (!surface_wanted(record)) return;
    record[SV_REC_PASSES] = passes;
    record[SV_REC_UNFILLED] = 0;
    record[SV_REC_OUTCOME] = SV_OUTCOME_OK;
}
