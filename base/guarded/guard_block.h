/* SPDX-License-Identifier: MIT */
/*
 * What host and guard child share: one block of memory, the frame's maps behind it, and the messages that say
 * whose turn it is. Both are the same program, so the layout is that of one compiler.
 *
 *   channel   hs_guard_order ->  the parent has filled in the block, the child works
 *             <- hs_guard_reply  the child has filled in the block, the parent reads
 *   block     hs_guard_block, then depth, confidence, scanned ranges, status (hs_guard_map_offset), each
 *             with a band behind it (smartvis/band.h)
 *   slabs     memory of its own, which the child can only read
 *
 * The parent believes nothing in it: it copies once, then looks at the copy. Texts end where their arrays do.
 */
#pragma once

#include "core/error.h"
#include "plugin/capabilities.h"
#include "plugin/loader_param.h"
#include "smartvis/band.h"

#include <stdatomic.h>

#define HS_GUARD_COMMAND    "guard-child" /* the hidden command of host_sim */
#define HS_GUARD_MAGIC      0x53564744u
#define HS_GUARD_MAX_AXIS   8192u /* pixels, as sv_format allows */
#define HS_GUARD_MAX_SLABS  8192u
#define HS_GUARD_MAX_VALUES 1024u
#define HS_GUARD_EXTENSIONS 16u /* ids of a descriptor; of more the rest are left out */

/* What is passed to the child. */
enum { HS_GUARD_PASSED_BLOCK = 1, HS_GUARD_PASSED_SLABS };

typedef enum {
    HS_GUARD_OPEN = 1, /* library, descriptors, create, parameters: open, then facts */
    HS_GUARD_ACTIVATE, /* format, values */
    HS_GUARD_DEACTIVATE,
    HS_GUARD_FRAME,           /* frame, slabs, values, result; then what `follow` asks for */
    HS_GUARD_ADJUST,          /* values, result; the same */
    HS_GUARD_FOLLOW,          /* what `follow` asks for, of the last frame */
    HS_GUARD_TEXT,            /* text */
    HS_GUARD_TIME,            /* number: on or off */
    HS_GUARD_TIMES,           /* times */
    HS_GUARD_READ_CONFIDENCE, /* confidence of the last frame, read in a [control] call */
    HS_GUARD_NEEDS,           /* needs */
    HS_GUARD_CLOSE            /* destroy, and the end of the child */
} hs_guard_op;

typedef struct {
    uint32_t op, number;
} hs_guard_order;

typedef struct {
    uint32_t op, number; /* those of the order */
    sv_status status;
} hs_guard_reply;

/* What a frame's message asks for beside the frame: bits. */
enum { HS_GUARD_POINTS = 1u << 0, HS_GUARD_CONFIDENCE = 1u << 1 };

/* Extensions that the instance has. */
enum {
    HS_GUARD_HAS_TIMING = 1u << 0,
    HS_GUARD_HAS_CONFIDENCE = 1u << 1,
    HS_GUARD_HAS_POINTS = 1u << 2,
    HS_GUARD_HAS_NEEDS = 1u << 3
};

/* A descriptor with its texts beside it: its own pointers mean nothing on the other side. */
typedef struct {
    sv_descriptor numbers;
    char id[256], name[256], vendor[256], version[64], summary[1024];
    uint32_t extension_count;
    char extension[HS_GUARD_EXTENSIONS][64];
} hs_guard_descriptor;

/* A parameter in the same way. A text that was NULL has no bit in `texts`. */
typedef struct {
    sv_status status; /* of param_info */
    sv_param_info numbers;
    uint32_t texts; /* bits: key, label, unit, help, group */
    char key[64], label[128], unit[32], help[1024], group[64];
} hs_guard_param;

/* What does not change while an instance lives. */
typedef struct {
    uint32_t abi_major, abi_minor;
    uint32_t plugin_count, chosen; /* `chosen` is the instance's own */
    uint32_t param_count;          /* as the plugin says; HS_MAX_PARAMS of them are here at most */
    uint32_t extensions;           /* HS_GUARD_HAS_* */
    hs_guard_descriptor plugin[HS_MAX_PLUGINS];
    hs_guard_param param[HS_MAX_PARAMS];
} hs_guard_facts;

/* A slab in the shared slab memory. */
typedef struct {
    uint32_t first_slice, slice_count;
    uint64_t offset, bytes;
} hs_guard_slab;

/* A question of smartvis.needs/1: pointers are NULL, but for host_memory's, which leads nowhere. */
typedef struct {
    sv_format format;
    uint32_t value_count;
    sv_param_value fixed[HS_GUARD_MAX_VALUES], values[HS_GUARD_MAX_VALUES];
    sv_needs_device device;
    sv_needs out;
} hs_guard_needs;

typedef struct {
    /* The call under way, for the sentence that tells how a child ended. `since_ns` is read while it runs. */
    char call[32];
    uint32_t step, steps; /* "slab 3 of 8"; 0 of 0 for other calls */
    _Atomic uint64_t since_ns;

    uint32_t magic;
    char last_error[1024]; /* the plugin's, for a status that is not SV_OK */
    char complaint[256];   /* hs_plugin.complaint */

    /* Read and written by HS_GUARD_OPEN. */
    char path[1024], id[256];
    uint32_t has_id;
    int32_t log_level;
    hs_error error; /* code HS_OK: opened */
    hs_guard_facts facts;

    /* By HS_GUARD_ACTIVATE: pointers in it are NULL. */
    sv_format format;
    hs_handover way;      /* how the plugin gets its slabs */
    uint64_t slabs_bytes; /* of the slab memory */
    uint32_t offered;     /* out: smartvis.confidence/1 gives a map */

    /* By HS_GUARD_FRAME and HS_GUARD_ADJUST: pointers are NULL. */
    sv_frame frame;
    uint32_t value_count, slab_count, follow;
    uint32_t want_status, has_scanned;
    sv_param_value values[HS_GUARD_MAX_VALUES];
    hs_guard_slab slabs[HS_GUARD_MAX_SLABS];
    sv_stats stats;          /* in and out */
    sv_points_report points; /* out: size 0 if it does not tell */
    sv_status confidence;    /* out: of write */

    /* By the orders of one answer: texts, times, and what extensions tell. */
    uint32_t number; /* HS_GUARD_TEXT: the parameter's id */
    double value;
    uint32_t text_bytes;
    char text[256];
    sv_stage_times times;
    sv_confidence_report confidence_report;
    hs_guard_needs needs;
} hs_guard_block;

/* The maps behind the block, in this order; as many pixels as the format has. */
typedef enum {
    HS_GUARD_DEPTH,
    HS_GUARD_CONFIDENCE_MAP,
    HS_GUARD_SCANNED,
    HS_GUARD_STATUS,
    HS_GUARD_MAPS
} hs_guard_map;

static inline size_t hs_guard_block_bytes(void) {
    return (sizeof(hs_guard_block) + 4095u) / 4096u * 4096u;
}

/* Bytes from the block's start to a map; of HS_GUARD_MAPS: the whole size. */
static inline size_t hs_guard_map_offset(hs_guard_map map, size_t pixels) {
    return hs_guard_block_bytes() + (map < HS_GUARD_MAPS ? (size_t)map * 4u : 13u) * pixels +
           (size_t)map * SV_BAND_BYTES;
}

/* The band behind a map. */
static inline void *hs_guard_band(hs_guard_block *block, hs_guard_map map, size_t pixels) {
    return (uint8_t *)block + hs_guard_map_offset((hs_guard_map)(map + 1), pixels) - SV_BAND_BYTES;
}

/* The child: loads the plugin and does what the channel orders, until it is closed. The hidden command
 * guard-child. Returns the exit code: HS_ERR_USAGE if the process was not started by a guard. */
int hs_guard_serve(void);
