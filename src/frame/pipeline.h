/* SPDX-License-Identifier: MIT */
/*
 * The stages of a frame and the buffers between them: profile (per slab), threshold and reconstruct (end of
 * the frame). After creation nothing here allocates, compiles or waits; commands are enqueued in order.
 */
#ifndef SV_PIPELINE_H
#define SV_PIPELINE_H

#include "abi/params.h"
#include "common/sv_shared.h"
#include "device/program.h"
#include "frame/timing.h"
#include "method/method.h"
#include "smartvis/points.h"

/* What stays the same from frame to frame; from sv_format and the parameters that need reactivation. */
typedef struct sv_config {
    uint32_t width, height, slices, max_slab_slices;
    uint32_t tiles_x, tile_w, tile_h, row_pitch; /* row_pitch of the texture as the kernels read it */
    uint32_t carrier;
    int32_t padding; /* SV_NO_PADDING: none */
    uint32_t substeps;
    uint32_t strategy;          /* SV_STRATEGY_*; AUTO is resolved by sv_pipeline_create */
    uint32_t method, prefilter; /* SV_METHOD_*, SV_PREFILTER_* */
    uint32_t merge_grid, spline_grid;
    uint32_t reduction; /* pixels along a side of the cells that the method works on; 1: pixels */
    bool half_sums;     /* mean filter: planes of 16 bits between passes */
    bool float32;       /* the solvers do without float64 even where the device has it */
    const void *host_memory;
    uint64_t host_memory_bytes;
} sv_config;

/* Buffers per stage. Rows of per-ray maps are padded to SV_LANES; see cl/common/sv_shared.h for the planes.
 */
typedef struct {
    cl_mem slab;       /* textures of a batch of slabs, where they are not read in place */
    cl_mem host_slabs; /* wraps sv_config.host_memory where slabs are read in place */
    cl_mem state8, state16;
    cl_mem survey;    /* bands: 257 words each */
    cl_mem histogram; /* 256 words */
    cl_mem status;
    cl_mem sums_a;          /* written with the points, whatever the method */
    cl_mem sums_b, scratch; /* mean filter only */
    cl_mem surfaces;        /* near, far: float32 slices */
    cl_mem record;          /* SV_REC_* */
    cl_mem depth;           /* the depthmap, where the host wants it in its memory */
} sv_buffers;

typedef struct sv_pipeline {
    sv_diag *diag;
    const sv_device *device;
    sv_program *narrow; /* kernels with 32-bit sums */
    sv_program *wide;   /* kernels with 64-bit sums; NULL if no setting needs them */
    sv_timing *timing;
    sv_config config;
    sv_buffers buffers;
    sv_chain chain;
    struct sv_pipeline *reduced; /* where the method works at a reduced resolution; else NULL */
    uint32_t spacing;            /* pixels of the depthmap from one pixel of this map to the next */
    uint32_t padded_width, bands, pass_capacity, batch_slots;
    uint64_t slab_bytes; /* of the longest slab */

    /* the frame under way, or the last one */
    sv_values values;
    sv_job job;
    sv_program *program; /* narrow or wide */
    uint32_t level_n;    /* T_L in 1 / substeps grey level */
    uint32_t next_slice;
    sv_batch batch;      /* slabs that wait for a launch */
    cl_mem batch_buffer; /* where they lie */
} sv_pipeline;

/* True if some frame with this format can need 64-bit sums. */
bool sv_pipeline_needs_wide(const sv_config *config);

/* Bytes of a slab texture up to its last voxel; 64-bit, so no format can overflow it. */
uint64_t sv_pipeline_slab_bytes(const sv_config *config, uint32_t slices);

/* Allocates. The pointed-to objects must outlive the pipeline. On failure nothing is left behind. */
sv_status sv_pipeline_create(sv_pipeline *pipeline, sv_diag *diag, const sv_device *device,
                             sv_program *narrow, sv_program *wide, sv_timing *timing,
                             const sv_config *config);

/* The smaller map of a reduced resolution: config, job and values follow those of `pipeline`, and so does
 * the record, which is shared; other buffers are those that a method uses. */
sv_status sv_pipeline_create_reduced(sv_pipeline *pipeline);

/* Launches every kernel of the method once, on no points. The self-test did so for the others. */
sv_status sv_pipeline_warm_up(sv_pipeline *pipeline);
void sv_pipeline_destroy(sv_pipeline *pipeline);

/* Enqueues a frame's stages. The caller has validated everything. */
void sv_pipeline_begin(sv_pipeline *pipeline, const sv_values *values);
sv_status sv_pipeline_slab(sv_pipeline *pipeline, const sv_slab *slab);
sv_status sv_pipeline_end(sv_pipeline *pipeline, float q);    /* up to the surfaces */
sv_status sv_pipeline_adjust(sv_pipeline *pipeline, float q); /* what another q asks for before the output */
sv_status sv_pipeline_output(sv_pipeline *pipeline, float q, const sv_result *result); /* S(q) and the rest */

/* Enqueues a read of what the points stage found out; valid when the queue has run. */
sv_status sv_pipeline_read_points(sv_pipeline *pipeline, sv_points_report *out);

#endif
