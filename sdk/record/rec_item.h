/* SPDX-License-Identifier: MIT */
/* The parts of a recording, and their one description, by which they are written and read
 * (docs/recording.md). */
#pragma once

#include "rules/call.h"

#include <stddef.h>

#define REC_MAGIC   "SVRECORD"
#define REC_VERSION 2u

/* What a recording begins with. */
typedef struct {
    char magic[8];
    uint32_t version, reserved;
} rec_header;
#define REC_HEADER                                                                                           \
    { REC_MAGIC, REC_VERSION, 0 }

typedef enum { REC_PLUGIN = 1, REC_CALL = 2, REC_RETURN = 3, REC_LOG = 4, REC_END = 5 } rec_type;

enum { REC_MAX_VALUES = 1024, REC_MAX_TEXT = 1023, REC_MAX_SIDE = 8192 };
#define REC_MAX_BYTES 0x7fffffffu /* of a chunk, and of what is packed in it */

/* How something came: not at all, in memory, in an OpenCL object. */
enum { REC_ABSENT = 0, REC_MEMORY = 1, REC_OBJECT = 2 };

typedef struct {
    uint32_t id, flags;
    char key[64];
} rec_param;

/* The one with this id, or NULL. A recording has no id twice. */
const rec_param *rec_find_param(const rec_param *params, uint32_t count, uint32_t id);

/* One part of a recording. Pointers in the ABI's structs are NULL. */
typedef struct {
    rec_type type;

    /* Fields of REC_PLUGIN. */
    char id[256], name[256], version[64];
    rec_param params[REC_MAX_VALUES];
    uint32_t param_count;

    /* Fields of REC_CALL and REC_RETURN. */
    uint32_t kind; /* rc_kind */
    uint32_t sound;
    uint64_t ns; /* a call's start, a return's duration */
    sv_param_value values[REC_MAX_VALUES];
    uint32_t value_count;
    sv_format format;
    uint32_t host_queue, registered; /* of activate */
    sv_frame frame;
    uint32_t ranges; /* REC_ABSENT .. */
    sv_slab slab;
    uint32_t voxels; /* 1: they are there */
    uint32_t depth_pitch, depth, status,
        stats; /* of end and adjust: where depths go; whether the others are asked */
    sv_status returned;
    char reason[REC_MAX_TEXT + 1];
    sv_stats found;
    uint32_t maps; /* 1: depths are there; 2: and the status map; 0: neither */

    /* Ranges or voxels of a call: width * height of sv_scanned, or slices without padding. Depths of a
     * return, and behind them the status map. */
    uint8_t *data;
    size_t bytes;

    /* Fields of REC_LOG. */
    int32_t severity;
    char text[REC_MAX_TEXT + 1];
} rec_item;

/* Where an item is read from, or written to. */
typedef struct {
    uint8_t *bytes; /* a writer's grow */
    size_t at, size;
    bool writes;
    const char *bad;         /* the field that cannot be, or NULL */
    const sv_format *format; /* the one that is active: sizes of maps and slabs; its width is 0 if none is */
} rec_cursor;

/* Writes the item, or reads it: `data` is then malloc'ed, or NULL. c->bad says what is wrong. */
void rec_item_pass(rec_cursor *c, rec_item *item);

/* Writes the item as a chunk of a file, from c->bytes on. Its length; 0 with c->bad if memory runs out or it
 * is too large. */
size_t rec_item_chunk(rec_cursor *c, rec_item *item);

/* CRC-32 of a chunk: its type, its length and its bytes. */
uint32_t rec_sum(uint32_t type, const uint8_t *bytes, uint32_t length);

/* ------------------------------------------------------------------------------------------- reading -- */

typedef struct rec_reader rec_reader;

/* Opens a recording of this version. NULL, and a sentence that names the file. */
rec_reader *rec_reader_open(const char *path, char *error, size_t bytes);

/* The next item; its data are the reader's until the next call. 1: there is one, 0: the recording has ended
 * as it should, -1: it is cut off or damaged, and `error` says where. */
int rec_reader_next(rec_reader *r, rec_item *item, char *error, size_t bytes);
void rec_reader_close(rec_reader *r);
