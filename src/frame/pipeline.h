/* SPDX-License-Identifier: MIT */
/*
 * The stages of a frame and the buffers between them: profile (per slab), threshold and reconstruct (end of
 * the frame). After creation nothing here allocates, compiles or waits; commands are enqueued in order.
 */
#pragma once

#include "method/chain.h"
#include "smartvis/points.h"

/* Buffers per stage. Rows of per-ray maps are padded to SV_LANES; cl/common/sv_shared.h has the planes. The
 * map of the frame has more. */
typedef struct {
    cl_mem slab;       /* textures of a batch of slabs, where they are not read in place */
    cl_mem host_slabs; /* wraps sv_config.host_memory where slabs are read in place */
    cl_mem state8, state16;
    cl_mem survey;    /* bands: 257 words each */
    cl_mem histogram; /* 256 words */
    cl_mem record;    /* SV_REC_* */
    cl_mem ranges;    /* the host's scanned ranges, where they come in its memory; NULL unless ranged */
    cl_mem scanned;   /* the scanned ranges as planes; see sv_map */
    cl_mem depth;     /* the depthmap, where the host wants it in its memory */
} sv_buffers;

/* A pipeline must not be moved: its parts point to each other. */
typedef struct {
    sv_queue queue;
    sv_config config;
    sv_buffers buffers;
    sv_map map; /* the frame's pixels */
    sv_chain chain;
    uint32_t pass_capacity, batch_slots;
    uint64_t slab_bytes; /* of the longest slab */

    /* the frame under way, or the last one */
    sv_frame_context context;
    bool ended;       /* else its volume was never seen, and none is the same */
    float q;          /* also of the last adjust */
    uint32_t level_n; /* T_L in 1 / substeps grey level */
    uint32_t next_slice;
    sv_placed_slabs waiting; /* slabs that wait for a launch */
} sv_pipeline;

/* What a pipeline takes: buffers, and commands of a frame and of an adjust behind it. */
typedef struct {
    uint64_t bytes, largest_buffer;
    uint32_t commands, adjust_commands;
} sv_demand;

/* What such a pipeline would take on such a device, without a call of OpenCL. A frame has these values and
 * slabs of `slab_slices`, each in an object of its own. */
sv_status sv_pipeline_demand(sv_diag *diag, const sv_device *device, const sv_config *config,
                             const sv_values *values, uint32_t slab_slices, sv_demand *out);

/* SV_OK if the device has room for the buffers of such a pipeline, else SV_ERR_FORMAT with both
 * numbers. Makes none. The host's log is told both. */
sv_status sv_pipeline_check_memory(sv_diag *diag, const sv_device *device, const sv_config *config);

/* The strategy that such a pipeline takes: the configuration's own, or what suits device and size. */
uint32_t sv_pipeline_strategy(const sv_device *device, const sv_config *config);

/* Makes the pipeline. `narrow`: kernels with 32-bit sums; `wide`: with 64-bit sums, NULL if no setting needs
 * them. The pointed-to objects must outlive the pipeline. On failure nothing is left behind. */
sv_status sv_pipeline_create(sv_pipeline *pipeline, sv_diag *diag, const sv_device *device,
                             const sv_program *narrow, const sv_program *wide, sv_timing *timing,
                             const sv_config *config);

/* Launches every kernel of the method once, on no points. The self-test did so for the others. */
sv_status sv_pipeline_warm_up(sv_pipeline *pipeline, const sv_values *values);
void sv_pipeline_destroy(sv_pipeline *pipeline);

/* Enqueues a frame's stages. The caller has validated everything. */
void sv_pipeline_begin(sv_pipeline *pipeline, const sv_values *values, const sv_frame_context *context);
/* Enqueues the scanned ranges after begin, if the format says that frames bring them: from host memory, or
 * from `object` from byte `offset` on. Memory must stay until the queue has run. */
sv_status sv_pipeline_scanned(sv_pipeline *pipeline, const sv_scanned *ranges, cl_mem object,
                              uint64_t offset);
sv_status sv_pipeline_slab(sv_pipeline *pipeline, const sv_slab *slab);

/* ---- the end of a frame (pipeline_end.c): bone threshold, initial points, reconstruction, S(q) and the
 * results */

sv_status sv_pipeline_end(sv_pipeline *pipeline);             /* up to the surfaces */
sv_status sv_pipeline_adjust(sv_pipeline *pipeline, float q); /* what another q asks for before the output */
sv_status sv_pipeline_output(sv_pipeline *pipeline, const sv_result *result); /* S(q) and the rest */

/* Enqueues a read of what the points stage found out; valid when the queue has run. */
sv_status sv_pipeline_read_points(sv_pipeline *pipeline, sv_points_report *out);

/* The last frame's confidence, for a method that gives one: to `map` (width * height) or, if that is NULL, to
 * `object` from byte `offset` on. Waits only if `wait` is set. */
sv_status sv_pipeline_confidence(sv_pipeline *pipeline, float *map, cl_mem object, uint64_t offset,
                                 bool wait);
