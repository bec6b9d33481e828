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

/* One work item: notes that every pixel has its surface, if there is one. */
__kernel void chain_done(uint passes, __global uint *restrict record) {
    if (!surface_wanted(record)) return;
    record[SV_REC_PASSES] = passes;
    record[SV_REC_UNFILLED] = 0;
    record[SV_REC_OUTCOME] = SV_OUTCOME_OK;
}
