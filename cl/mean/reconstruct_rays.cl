/* SPDX-License-Identifier: MIT */
/*
 * From ray states to surfaces, for GPUs: one pixel per work item. The same steps and the same integer sums as
 * reconstruct.cl, so the same bits; a window is summed directly, columns first, then rows, because a GPU has
 * threads to spare and no use for long serial runs. band_level and band_record of reconstruct.cl serve both.
 */
#ifndef SV_SUMS_CLH
#include "mean/sums.clh"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* Empties the survey (257 words: maximum, then 256 counts). One work item per word. */
__kernel void rays_clear(__global uint *restrict survey) {
    survey[get_global_id(0)] = 0;
}

/* Maximum and histogram of the ray maxima. */
__kernel void rays_survey(sv_job job, __global const uchar *restrict state8,
                          volatile __global uint *restrict survey) {
    const uint x = (uint)get_global_id(0);
    const uint y = (uint)get_global_id(1);
    if (x >= job.width) return;
    const uint maximum = state8[(size_t)y * job.padded_width + x];
    atomic_max(survey, maximum);
    if (job.bone_mode == SV_BONE_FRACTION) atomic_inc(survey + 1 + maximum);
}

/* Position in samples to fixed-point slices. */
static sum_t ray_fixed(uint position, uint fraction) {
    return (((sum_t)position << fraction) + (sum_t)(SV_SUBSTEPS / 2)) / (sum_t)SV_SUBSTEPS;
}

/* Initial points; pixels in the rows' padding get no weight. */
__kernel void rays_points(sv_job job, __global const uchar *restrict state8,
                          __global const ushort *restrict state16, __global uchar *restrict status,
                          __global sum_t *restrict sums, __global float *restrict surfaces,
                          volatile __global uint *restrict record) {
    const size_t i = (size_t)get_global_id(1) * job.padded_width + get_global_id(0);
    const size_t plane = (size_t)job.padded_width * job.height;
    if (get_global_id(0) >= job.padded_width) return;
    const uint entry = state16[SV_STATE_MAX_ENTRY * plane + i];
    const uint exit = state16[SV_STATE_MAX_EXIT * plane + i];
    const bool bone = get_global_id(0) < job.width && state8[i] > record[SV_REC_LEVEL];
    const bool open = entry > exit;
    const bool point = bone && (open || !job.drop_empty);
    const sum_t weight = point ? job.weight_initial : 0;
    sums[SV_SUM_NEAR * plane + i] = point && open ? ray_fixed(exit, job.fraction) * weight : 0;
    sums[SV_SUM_FAR * plane + i] = point && open ? ray_fixed(entry, job.fraction) * weight : 0;
    sums[SV_SUM_WEIGHT * plane + i] = weight;
    status[i] = (uchar)(point ? (open ? SV_STATUS_INITIAL : SV_STATUS_EMPTY) : SV_STATUS_NONE);
    surfaces[i] = 0.0f;
    surfaces[plane + i] = 0.0f;
    if (bone) atomic_inc(record + SV_REC_BONE);
    if (point) atomic_inc(record + SV_REC_POINTS);
    if (point && !open) atomic_inc(record + SV_REC_EMPTY);
    if (bone && open && entry - exit >= job.min_gap) atomic_inc(record + SV_REC_EVIDENT);
}

/* Columns of the windows: columns[p][y][x] = sum of from[p] over rows y - r .. y + r inside the image. */
__kernel void rays_columns(sv_job job, uint number, __global const sum_t *restrict from,
                           __global sum_t *restrict columns, volatile __global uint *restrict record) {
    if (!pass_needed(record, number)) return;
    const uint x = (uint)get_global_id(0);
    const uint y = (uint)get_global_id(1);
    if (x >= job.width) return;
    const size_t plane = (size_t)job.padded_width * job.height;
    const uint r = job.k / 2;
    for (uint p = 0; p < SV_SUM_PLANES; p++) {
        sum_t sum = 0;
        for (uint row = y > r ? y - r : 0; row <= min(y + r, job.height - 1); row++)
            sum += from[p * plane + (size_t)row * job.padded_width + x];
        columns[p * plane + (size_t)y * job.padded_width + x] = sum;
    }
}

/* Rows of the windows, the means, and what the next pass starts from. */
__kernel void rays_means(sv_job job, uint number, __global const sum_t *restrict columns,
                         __global sum_t *restrict to, __global float *restrict surfaces,
                         __global const uchar *restrict status, volatile __global uint *restrict record) {
    if (!pass_needed(record, number)) return;
    const uint x = (uint)get_global_id(0);
    const uint y = (uint)get_global_id(1);
    if (x >= job.width) return;
    const size_t plane = (size_t)job.padded_width * job.height;
    const size_t i = (size_t)y * job.padded_width + x;
    const uint r = job.k / 2;
    sum_t sum[SV_SUM_PLANES];
    for (uint p = 0; p < SV_SUM_PLANES; p++) {
        sum[p] = 0;
        for (uint column = x > r ? x - r : 0; column <= min(x + r, job.width - 1); column++)
            sum[p] += columns[p * plane + (size_t)y * job.padded_width + column];
    }
    const sum_t weight = sum[SV_SUM_WEIGHT];
    const sum_t next = weight == 0 ? 0 : status[i] ? job.weight_initial : job.weight_filled;
    for (uint p = 0; p < SV_SUM_WEIGHT; p++) {
        const float quotient = sv_quotient(sum[p], weight);
        const sum_t rounded = sv_round(quotient, sum[p], weight);
        surfaces[p * plane + i] = sv_slices(quotient, rounded, job.fraction);
        to[p * plane + i] = rounded * next;
    }
    to[SV_SUM_WEIGHT * plane + i] = next;
    if (weight == 0) atomic_inc(record + SV_REC_PASS0 + number);
}
