/* SPDX-License-Identifier: MIT */
/*
 * A small C host: what it has ready for frames of one format, which are slabs cut from a volume, scanned
 * ranges, and memory for results with guard bands around it and between its rows; and the calls of a frame.
 */
#pragma once

#include "smartvis/needs.h"
#include "smartvis_plugin.h"

#include <CL/cl.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a host hands to a plugin that works on the host's queue. Borrowed. */
typedef struct {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue; /* in-order */
} stage_device;

/* Told what could not be had, with OpenCL's error; CL_SUCCESS: it is not OpenCL's. Must not return. */
typedef void (*stage_failure)(void *data, const char *what, cl_int code);

enum { STAGE_MAX_SLABS = 1024, STAGE_MAX_FIXED = 64 };

/* One way of handing volumes over. */
typedef struct {
    uint32_t width, height, slices;
    uint32_t longest;        /* slices of the longest slab */
    const uint32_t *lengths; /* of the slabs, ended by 0; NULL: `longest` each, the last one short */
    uint32_t tiles_x, extra_w, extra_h, extra_pitch;
    uint32_t carrier; /* SV_CARRIER_... */
    bool own_queue;   /* else the host's */
    bool ranges;      /* frames bring scanned ranges */
    bool ranges_in_buffer;
    bool registered;     /* the slabs' memory is named at activation */
    bool exact;          /* a slab's memory ends where its bytes do: what follows cannot be read */
    float spacing_mm[3]; /* zeros: not told */
    int32_t padding;     /* 0 .. 255 or SV_NO_PADDING */
    uint8_t hatch;       /* value of bytes that belong to no slice */
    uint32_t pitch;      /* floats from one row of the map to the next beyond the width */
    bool depth_object;   /* the map goes to an OpenCL buffer */
    uint32_t fixed_count;
    sv_param_value fixed[STAGE_MAX_FIXED]; /* values for activate */
} stage_way;

typedef struct stage {
    stage_failure failed;
    void *data;
    stage_way way;
    stage_device device; /* zeros with an own queue */
    sv_format format;
    uint32_t slab_count;
    uint32_t first[STAGE_MAX_SLABS], length[STAGE_MAX_SLABS];
    uint64_t bytes[STAGE_MAX_SLABS];
    uint8_t *pages, *memory[STAGE_MAX_SLABS]; /* the slabs' textures, in one mapping */
    size_t page_bytes;
    cl_mem objects[STAGE_MAX_SLABS];
    sv_frame told;        /* what every frame tells of probe and beams; zeros at first */
    uint32_t frame_size;  /* of its struct; 0: all of it */
    uint32_t frame_flags; /* SV_FRAME_DISCONTINUITY at first */
    sv_scanned *ranges;   /* as they are handed over */
    cl_mem ranges_object;

    uint8_t *results; /* one block: guard, map, guard, status map, guard, statistics, guard */
    size_t result_bytes, depth_at, status_at, stats_at, row_bytes;
    cl_mem depth_object;
} stage;

/* `device` may be NULL if the way has an own queue. It is borrowed, as the values of the way are. */
void stage_make(stage *st, const stage_way *way, const stage_device *device, stage_failure failed,
                void *data);
void stage_free(stage *st);

/* Puts a volume into the slabs (x runs fastest, then y, then z), and the ranges of its rays into place. */
void stage_fill(stage *st, const uint8_t *voxels, const sv_scanned *ranges);

sv_slab stage_slab(const stage *st, uint32_t n);
sv_frame stage_frame(const stage *st, const sv_param_value *values, uint32_t count);
sv_result stage_result(stage *st);

/* Every byte of the results becomes `byte`; statistics get their size. */
enum { STAGE_POISON = 0xff }; /* as a float: NaN */
void stage_poison(stage *st, uint8_t byte);

/* The first byte of the guard bands that is not `byte`, in words, or NULL. */
const char *stage_trespass(const stage *st, uint8_t byte);

/* A sum over everything that a plugin must not change. */
uint64_t stage_inputs(const stage *st);

/* begin, all slabs, end, and with the host's queue clFinish. Returns the first status that is not SV_OK, else
 * what end returned. `result` may be the stage's or another. The instance must be active with this format. */
sv_status stage_run(const stage *st, const sv_plugin *p, const sv_param_value *values, uint32_t count,
                    const sv_result *result);

/* True if slabs can be images there: of one channel of 8 bits, with both types that the header names. A
 * device may have images and none of these (PoCL 7.1). */
bool stage_has_images(const stage_device *device);

/* What smartvis.needs/1 asks of a device. */
sv_needs_device stage_facts(cl_device_id device);
