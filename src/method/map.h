/* SPDX-License-Identifier: MIT */
/*
 * The place a method works on: the frame's own pixels, or the cells of a reduced resolution. A method
 * sees a map and nothing else of the frame; lengths, windows and weights in `job` and `values` are in the
 * map's own pixels.
 */
#ifndef SV_MAP_H
#define SV_MAP_H

#include "common/sv_shared.h"
#include "device/program.h"
#include "device/queue.h"
#include "method/values.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- what stays the same from frame to frame; from sv_format and the parameters that need reactivation */

typedef struct {
    uint32_t width, height, slices, max_slab_slices;
    uint32_t tiles_x, tile_w, tile_h, row_pitch; /* row_pitch of the texture as the kernels read it */
    uint32_t carrier;
    int32_t padding;  /* SV_NO_PADDING: none */
    bool ranged;      /* every frame brings the scanned range of every ray */
    float spacing[3]; /* mm between voxels; never 0: where the host does not know it, assumed */
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

/* ---- the map */

typedef struct {
    const sv_queue *queue;
    const sv_program *narrow,
        *wide;               /* kernels with 32-bit sums, with 64-bit sums (NULL: nothing needs them) */
    const sv_config *config; /* of the frame; its sizes are not the map's */
    uint32_t width, height;
    uint32_t padded_width; /* of the rows of every buffer: a multiple of SV_LANES */
    uint32_t bands;        /* bands of rows that work items share, strategy bands */
    uint32_t spacing;      /* pixels of the frame from one pixel of this map to the next */
    uint32_t sum_bytes;    /* of a value in the mean filter's planes: 4, or 8 if a frame can need wide sums */
    bool doubles;          /* the spline's solver computes in float64 */

    /* Rows of padded_width. The map owns them, except for the last two, which are the frame's. */
    cl_mem status;   /* 8 bits a pixel: SV_STATUS_* */
    cl_mem surfaces; /* near, far: float32 slices */

    /* Near and far plane: float32 depth at initial points, INFINITY elsewhere. NULL if the method takes the
     * sums. */
    cl_mem points;

    /* The mean filter's first planes, where the points stage or the method writes them; or NULL. */
    cl_mem sums;

    cl_mem scanned; /* planes SV_SCANNED_*, 16 bits; NULL unless config->ranged */
    cl_mem record;  /* SV_REC_* */

    /* the frame under way, or the last one */
    bool continues; /* the volume before is of the same scene: what it taught still holds */
    float probe_rotation[9], probe_side[3]; /* as in sv_frame; zeros: unknown */
    sv_values values;
    sv_job job;
    const sv_program *program; /* narrow or wide */
} sv_map;

/* True if some frame of a method that takes sums can need 64-bit ones. */
bool sv_map_needs_wide(const sv_config *config);

/* Sizes of a map whose pixels lie `spacing` pixels of the frame apart. Makes no buffer. `wide_sums`: planes
 * of sums leave room for 64 bits. The pointed-to objects must outlive the map. */
void sv_map_init(sv_map *map, const sv_queue *queue, const sv_config *config, uint32_t spacing,
                 bool wide_sums);

/* Makes the buffers that every method needs, and (with_sums) the mean filter's first planes. */
sv_status sv_map_buffers(sv_map *map, bool with_sums, cl_mem record);

/* Makes the maps of the points. */
sv_status sv_map_point_buffers(sv_map *map);
void sv_map_release(sv_map *map);

/* Takes a frame's job and values, and chooses what depends on the map's size: passes, and the format
 * of the sums. */
void sv_map_begin(sv_map *map, const sv_job *job, const sv_values *values);

/* Takes the job and values of `frame` for a map of cells, in whose units lengths are counted. Lambda is an
 * area (docs/algorithm.md). */
void sv_map_begin_reduced(sv_map *map, const sv_map *frame);

/* Notes in the map's record that every pixel has a surface after so many passes, or what the passes
 * themselves counted. */
sv_status sv_map_done_passes(const sv_map *map);

/* Begins a launch of one of the frame's kernels, by its name, with the map's job as the first argument. */
#define SV_LAUNCH(map, name)     sv_launch_begin((map)->queue, (map)->program->name, #name)
#define SV_LAUNCH_JOB(map, name) sv_launch_job((map)->queue, (map)->program->name, #name, &(map)->job)

#endif
