/* SPDX-License-Identifier: MIT */
/*
 * What lies in memory. Of every slab one row of voxels is sampled in a column of its tiles, and one row of
 * the ranges, another one every frame: before the plugin's call, and when the frame has run. Maps are NaN
 * before the plugin writes them.
 *
 * With the plugin's own queue this is done on the spot. With the host's it is commands in order with the
 * plugin's, into a buffer of the layer's, and what they bring is judged at a later call. A few frames may be
 * under way; of one that finds no free slot nothing is judged.
 */
#pragma once

#include "layer/layer.h"
#include "smartvis/band.h"

#include <CL/cl.h>

/* A volume that needs more memory for watching it is not watched. */
enum { LY_SLOTS = 4, LY_MAX_LINE = 1024, LY_MAX_BYTES = 64 << 20, LY_OWN_BYTES = 64 << 10 };

/* A row of equal pieces in the host's memory, or in an object of the host's. */
typedef struct {
    const uint8_t *memory;
    cl_mem object;
    bool image;
    size_t origin[3]; /* of the first piece: bytes (buffer), or x, y (image) */
    size_t pitch, bytes, lines;
    size_t at; /* of its sample */
    uint32_t row;
    uint32_t slice, step; /* of the first line, and from line to line; LY_RANGES: rows of ranges */
} ly_place;
#define LY_RANGES UINT32_MAX

/* One frame or adjust on its way. The block is samples before, samples after, map, status map, statistics; of
 * the host's memory the samples before are in `kept`. */
typedef struct {
    cl_mem device;
    uint8_t *block, *kept;
    cl_event done; /* NULL: the slot is free */
    ly_place *places;
    uint32_t count;
    size_t used;    /* bytes of samples */
    uint64_t index; /* the host's */
    uint32_t row;
    rc_kind kind;
    sv_status returned;
    uint32_t stats_size; /* as the host set it */
    bool status, stats;  /* are in the block */
    bool muddled;        /* another call came between: it is not judged */
} ly_slot;

struct ly_watch {
    sv_format format;
    size_t samples, rays, bytes;         /* room for samples of a frame; of a block */
    uint32_t max_places, rows, row_step; /* rows that are sampled of a slice */
    uint32_t before_slab;                /* places before those of the slab under way */
    ly_slot slots[LY_SLOTS];
    uint32_t slot_count;
    ly_slot *now;   /* of the frame under way; NULL: it is not sampled */
    uint64_t turn;  /* frames so far: chooses row and tile */
    uint8_t *lent;  /* own queue: maps for the plugin, with bands behind them; NULL: it gets the host's */
    cl_int trouble; /* one of the layer's own commands failed: it watches no more */
};

/* Where the parts of a block are. */
static inline size_t ly_depth_at(const ly_watch *w) {
    return 2 * w->samples;
}
static inline size_t ly_status_at(const ly_watch *w) {
    return ly_depth_at(w) + w->rays * sizeof(float);
}
static inline size_t ly_stats_at(const ly_watch *w) {
    return (ly_status_at(w) + w->rays + 7) / 8 * 8;
}

/* True with the plugin's own queue. */
static inline bool ly_is_own(const ly_watch *w) {
    return !w->format.queue;
}

/* ---------------------------------------------------------------------------------- layer_results -- */

/* Enqueues the way of a sample to byte `to` of the slot's buffer. */
void ly_fetch(ly_watch *w, const ly_slot *s, const ly_place *p, size_t to);

/* Before the plugin's call: depths become NaN; with the plugin's own queue other results change, too. */
void ly_results_before(ly_watch *w, const sv_result *r);

/* Behind it: judges the results, or enqueues their way into the block. */
void ly_results_after(ly_instance *i, const rc_call *c);

/* What is in the slot's block. */
void ly_results_judge(ly_instance *i, const ly_slot *s);
