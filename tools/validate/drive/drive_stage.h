/* SPDX-License-Identifier: MIT */
/*
 * What a host has ready for frames of one format: slabs cut from a volume, scanned ranges, and memory for
 * results with guard bands around it and between its rows.
 */
#ifndef DRIVE_STAGE_H
#define DRIVE_STAGE_H

#include "validate/drive/drive_device.h"
#include "validate/drive/drive_subject.h"
#include "validate/drive/drive_volume.h"

enum { V_MAX_SLABS = 64, V_MAX_FIXED = 64 };

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
    bool registered;   /* the slabs' memory is named at activation */
    bool exact;        /* a slab's memory ends where its bytes do: what follows cannot be read */
    int32_t padding;   /* 0 .. 255 or SV_NO_PADDING */
    uint8_t hatch;     /* value of bytes that belong to no slice */
    uint32_t pitch;    /* floats from one row of the map to the next beyond the width */
    bool depth_object; /* the map goes to an OpenCL buffer */
    uint32_t fixed_count;
    sv_param_value fixed[V_MAX_FIXED]; /* values for activate */
} v_way;

/* Host memory, three slabs, three tiles a row with some padding around, and ranges if the plugin takes them.
 * The host's queue if the plugin takes that, else its own. */
v_way v_standard_way(const v_subject *s);

/* Another size, in as many slabs as before. */
v_way v_sized(v_way way, uint32_t width, uint32_t height, uint32_t slices);

typedef struct {
    v_run *run;
    v_way way;
    const v_device *device; /* NULL with an own queue */
    sv_format format;
    uint32_t slab_count;
    uint32_t first[V_MAX_SLABS], length[V_MAX_SLABS];
    uint64_t bytes[V_MAX_SLABS];
    uint8_t *pages, *memory[V_MAX_SLABS]; /* the slabs' textures, in one mapping */
    size_t page_bytes;
    cl_mem objects[V_MAX_SLABS];
    sv_scanned *ranges; /* as they are handed over */
    cl_mem ranges_object;

    uint8_t *results; /* one block: guard, map, guard, status map, guard, statistics, guard */
    size_t result_bytes, depth_at, status_at, stats_at, row_bytes;
    cl_mem depth_object;
} v_stage;

/* `device` may be NULL if the way has an own queue. Skips the check if OpenCL refuses an object. */
void v_stage_make(v_run *run, v_stage *st, const v_way *way, const v_device *device);
void v_stage_free(v_stage *st);

/* Puts a volume into the slabs, and its ranges into place. */
void v_stage_fill(v_stage *st, const v_volume *v);

sv_slab v_stage_slab(const v_stage *st, uint32_t n);
sv_frame v_stage_frame(const v_stage *st, const sv_param_value *values, uint32_t count);
sv_result v_stage_result(v_stage *st);

/* Every byte of the results becomes `byte`; statistics get their size. */
enum { V_POISON = 0xff }; /* as a float: NaN */
void v_stage_poison(v_stage *st, uint8_t byte);

/* The first byte of the guard bands that is not `byte`, in words, or NULL. */
const char *v_stage_trespass(const v_stage *st, uint8_t byte);

/* A sum over everything that a plugin must not change. */
uint64_t v_stage_inputs(const v_stage *st);

#endif
