/* SPDX-License-Identifier: MIT */
/*
 * From ray states to surfaces, for CPU devices: bone threshold, initial points, mean filter passes.
 * `frame_end` does it all in one launch and one work item, which is best for small maps, where a launch costs
 * as much as a pass. The others split the rows into bands, one work item each, and take one launch per step;
 * a pass that is not needed returns at once, so that nobody has to read a flag back.
 */
#ifndef SV_MEAN_CLH
#include "mean/mean.clh"
#endif
#pragma OPENCL FP_CONTRACT OFF

/* Starts the frame's record: no surface until a pass says otherwise. */
static void record_start(__global uint *record, const sv_job *f, uint maximum, uint level,
                         point_counts count) {
    record[SV_REC_OUTCOME] = SV_OUTCOME_NO_SURFACE;
    record[SV_REC_RAYS] = f->width * f->height;
    record[SV_REC_POINTS] = count.points;
    record[SV_REC_EMPTY] = count.empty;
    record[SV_REC_EVIDENT] = count.evident;
    record[SV_REC_BONE] = count.bone;
    record[SV_REC_EVIDENCE] = f->evidence;
    record[SV_REC_PASSES] = 0;
    record[SV_REC_UNFILLED] = f->width * f->height;
    record[SV_REC_MAX] = as_uint((float)maximum / 255.0f);
    record[SV_REC_TB] = as_uint((float)level / 255.0f);
    record[SV_REC_LEVEL] = level;
}

/* Writes the pixels that a pass left unfilled. */
static void record_pass(__global uint *record, uint number, uint unfilled) {
    record[SV_REC_PASSES] = number + 1;
    record[SV_REC_UNFILLED] = unfilled;
    record[SV_REC_OUTCOME] = unfilled == 0 ? SV_OUTCOME_OK : SV_OUTCOME_PARTIAL;
}

/* Surfaces of zeros, which clip nothing: what is left if there is no surface. */
static void clear_surfaces(__global float *surfaces, const sv_job *f, uint y0, uint y1) {
    const size_t plane = (size_t)f->padded_width * f->height;
    for (size_t i = (size_t)y0 * f->padded_width; i < (size_t)y1 * f->padded_width; i += SV_LANES) {
        vstore16((float16)(0.0f), 0, surfaces + i);
        vstore16((float16)(0.0f), 0, surfaces + plane + i);
    }
}

__kernel void frame_end(sv_job job, __global const uchar *restrict state8,
                        __global const ushort *restrict state16, __global uint *restrict histogram,
                        __global uchar *status, __global sum_t *sums_a, __global sum_t *sums_b,
                        __global sum_t *scratch, __global float *surfaces, __global uint *record) {
    const uint rows = job.height;
    const uint maximum = rows_maximum(state8, job.padded_width, 0, rows);
    /* No loop in a branch of the mode: PoCL 7.1 aborts on that (docs/architecture.md). */
    const uint counted = job.bone_mode == SV_BONE_FRACTION ? rows : 0;
    for (uint i = 0; i < 256; i++) histogram[i] = 0;
    rows_histogram(state8, job.width, job.padded_width, 0, counted, histogram);
    const uint level = bone_level_of(&job, maximum, histogram);
    const point_counts count = rows_points(&job, state8, state16, level, 0, rows, status, sums_a);
    record_start(record, &job, maximum, level, count);
    if (!surface_wanted(record)) clear_surfaces(surfaces, &job, 0, rows);
    for (uint pass = 0; pass < job.pass_limit && pass_needed(record, pass); pass++) {
        const pass_t p = {pass % 2 ? sums_b : sums_a, pass % 2 ? sums_a : sums_b, surfaces, status, scratch};
        const uint unfilled = rows_mean(&job, &p, 0, rows);
        record[SV_REC_PASS0 + pass] = unfilled;
        record_pass(record, pass, unfilled);
    }
}

/* Rows of this work item's band. */
static uint2 band_rows(uint height) {
    const uint bands = (uint)get_global_size(0);
    const uint band = (uint)get_global_id(0);
    return (uint2)((uint)((ulong)height * band / bands), (uint)((ulong)height * (band + 1) / bands));
}

/* Step 1 of the banded way: maximum of a band's rays, or their histogram (257 words a band:
 * maximum, then counts). */
__kernel void band_survey(sv_job job, __global const uchar *restrict state8, __global uint *restrict bands) {
    const uint2 rows = band_rows(job.height);
    __global uint *mine = bands + get_global_id(0) * 257;
    mine[0] = rows_maximum(state8, job.padded_width, rows.x, rows.y);
    if (job.bone_mode == SV_BONE_FRACTION) {
        for (uint i = 1; i < 257; i++) mine[i] = 0;
        rows_histogram(state8, job.width, job.padded_width, rows.x, rows.y, mine + 1);
    }
}

/* Step 2, one work item: the bone level, and an empty record. */
__kernel void band_level(sv_job job, __global const uint *restrict bands, uint band_count,
                         __global uint *restrict histogram, __global uint *restrict record) {
    uint maximum = 0;
    for (uint b = 0; b < band_count; b++) maximum = max(maximum, bands[b * 257]);
    if (job.bone_mode == SV_BONE_FRACTION)
        for (uint i = 0; i < 256; i++) {
            histogram[i] = 0;
            for (uint b = 0; b < band_count; b++) histogram[i] += bands[b * 257 + 1 + i];
        }
    const point_counts none = {0, 0, 0, 0};
    record_start(record, &job, maximum, bone_level_of(&job, maximum, histogram), none);
    for (uint pass = 0; pass < job.pass_limit; pass++) record[SV_REC_PASS0 + pass] = 0;
}

/* Step 3: initial points. */
__kernel void band_points(sv_job job, __global const uchar *restrict state8,
                          __global const ushort *restrict state16, __global uchar *restrict status,
                          __global sum_t *restrict sums, __global float *restrict surfaces,
                          volatile __global uint *restrict record) {
    const uint2 rows = band_rows(job.height);
    const point_counts count =
        rows_points(&job, state8, state16, record[SV_REC_LEVEL], rows.x, rows.y, status, sums);
    clear_surfaces(surfaces, &job, rows.x, rows.y);
    atomic_add(record + SV_REC_BONE, count.bone);
    atomic_add(record + SV_REC_POINTS, count.points);
    atomic_add(record + SV_REC_EMPTY, count.empty);
    atomic_add(record + SV_REC_EVIDENT, count.evident);
}

/* Steps from 4 on: one pass each. */
__kernel void band_mean(sv_job job, uint number, __global const sum_t *restrict from,
                        __global sum_t *restrict to, __global float *restrict surfaces,
                        __global const uchar *restrict status, __global sum_t *restrict scratch,
                        volatile __global uint *restrict record) {
    if (!pass_needed(record, number)) return;
    const uint2 rows = band_rows(job.height);
    const size_t stride = job.padded_width + SV_ROW_SLACK;
    const pass_t p = {from, to, surfaces, status, scratch + get_global_id(0) * SV_SCRATCH_ROWS * stride};
    const uint unfilled = rows_mean(&job, &p, rows.x, rows.y);
    if (unfilled > 0) atomic_add(record + SV_REC_PASS0 + number, unfilled);
}

/* Last step, one work item: notes the outcome of the passes. */
__kernel void band_record(uint pass_limit, __global uint *restrict record) {
    for (uint pass = 0; pass < pass_limit && pass_needed(record, pass); pass++)
        record_pass(record, pass, record[SV_REC_PASS0 + pass]);
}
