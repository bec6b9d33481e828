/* SPDX-License-Identifier: MIT */
#include "record/rec_item.h"
#include "record/rec.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a recording holds little-endian numbers");

const char *const rc_names[RC_CALLS] = {"create", "destroy", "activate", "deactivate",
                                        "begin",  "slab",    "end",      "adjust"};

/* ---- numbers and texts */
static void fail(rec_cursor *c, const char *field) {
    if (!c->bad) c->bad = field;
}

static void *place(rec_cursor *c, size_t bytes, const char *field) {
    if (c->bad) return NULL;
    if (c->writes && c->size - c->at < bytes) {
        const size_t size = 2 * c->size + bytes;
        uint8_t *grown = realloc(c->bytes, size);
        if (!grown) {
            fail(c, "memory");
            return NULL;
        }
        c->bytes = grown;
        c->size = size;
    }
    if (c->size - c->at < bytes) {
        fail(c, field);
        return NULL;
    }
    c->at += bytes;
    return c->bytes + c->at - bytes;
}

static void pass(rec_cursor *c, void *value, size_t bytes, const char *field) {
    void *there = place(c, bytes, field);
    if (!there) {
        if (!c->writes) memset(value, 0, bytes);
        return;
    }
    memcpy(c->writes ? there : value, c->writes ? value : there, bytes);
}
#define PASS(c, field) pass(c, &(field), sizeof(field), #field)

/* A number that is at most so large. */
static void pass_limited(rec_cursor *c, uint32_t *value, uint32_t maximum, const char *field) {
    pass(c, value, sizeof *value, field);
    if (*value <= maximum) return;
    fail(c, field);
    *value = 0;
}
#define PASS_LIMITED(c, field, maximum) pass_limited(c, &(field), maximum, #field)

static void pass_text(rec_cursor *c, char *text, size_t room, const char *field) {
    uint32_t length = c->writes ? (uint32_t)strlen(text) : 0;
    pass_limited(c, &length, (uint32_t)room - 1, field);
    pass(c, text, length, field);
    text[length] = '\0';
}
#define PASS_TEXT(c, field) pass_text(c, field, sizeof(field), #field)

/* ---- packed bytes */
/* Deflate shrinks to 1/1032 at best: what claims to be larger is no recording, and takes no memory. */
enum { MAX_SHRUNK = 1032 };

/* Speckle has no patterns, so runs are looked for and no more: as small as any other way, and the fastest. */
static void pack(rec_cursor *c, uint8_t *data, size_t bytes) {
    z_stream z = {0};
    if (deflateInit2(&z, 1, Z_DEFLATED, 15, 9, Z_RLE) != Z_OK) {
        fail(c, "memory");
        return;
    }
    const size_t room = deflateBound(&z, (uLong)bytes), head = c->at;
    uint32_t packed = 0;
    pass(c, &packed, sizeof packed, "memory");
    z.next_out = place(c, room, "memory");
    z.avail_out = (uInt)room;
    z.next_in = data;
    z.avail_in = (uInt)bytes;
    if (!z.next_out || deflate(&z, Z_FINISH) != Z_STREAM_END) fail(c, "memory");
    packed = (uint32_t)z.total_out;
    (void)deflateEnd(&z);
    if (c->bad) return;
    c->at = head + sizeof packed + packed;
    memcpy(c->bytes + head, &packed, sizeof packed);
}

static void unpack(rec_cursor *c, uint8_t *data, size_t bytes, const char *field) {
    uint32_t packed = 0;
    uLongf length = (uLongf)bytes;
    pass(c, &packed, sizeof packed, field);
    const uint8_t *there = place(c, packed, field);
    if (there && (uncompress(data, &length, there, packed) != Z_OK || length != bytes)) fail(c, field);
}

/* `bytes` of item->data from its end on; a reader's data grow by them. */
static void pass_data(rec_cursor *c, rec_item *item, uint64_t bytes, const char *field) {
    if (c->bad) return;
    if (c->writes) {
        if (bytes > REC_MAX_BYTES)
            fail(c, field);
        else
            pack(c, item->data + item->bytes, (size_t)bytes);
        item->bytes += (size_t)bytes;
        return;
    }
    if (bytes == 0 || bytes > REC_MAX_BYTES || bytes / MAX_SHRUNK > c->size - c->at) {
        fail(c, field);
        return;
    }
    uint8_t *grown = realloc(item->data, item->bytes + (size_t)bytes);
    if (!grown) {
        fail(c, "memory");
        return;
    }
    item->data = grown;
    unpack(c, grown + item->bytes, (size_t)bytes, field);
    item->bytes += (size_t)bytes;
}

/* ---- the parts */
const rec_param *rec_find_param(const rec_param *params, uint32_t count, uint32_t id) {
    for (uint32_t i = 0; i < count; i++)
        if (params[i].id == id) return &params[i];
    return NULL;
}

static void pass_plugin(rec_cursor *c, rec_item *it) {
    PASS_TEXT(c, it->id);
    PASS_TEXT(c, it->name);
    PASS_TEXT(c, it->version);
    PASS_LIMITED(c, it->param_count, REC_MAX_VALUES);
    for (uint32_t i = 0; i < it->param_count && !c->bad; i++) {
        PASS(c, it->params[i].id);
        if (rec_find_param(it->params, i, it->params[i].id)) fail(c, "params.id");
        PASS(c, it->params[i].flags);
        PASS_TEXT(c, it->params[i].key);
    }
}

static void pass_values(rec_cursor *c, rec_item *it) {
    PASS_LIMITED(c, it->value_count, REC_MAX_VALUES);
    for (uint32_t i = 0; i < it->value_count && !c->bad; i++) {
        PASS(c, it->values[i].id);
        PASS(c, it->values[i].value);
    }
}

/* Names the field of a sound activate that every plugin refuses. */
static const char *check_format(const sv_format *f, bool host_queue) {
    return f->width == 0                                  ? "width"
           : f->height == 0                               ? "height"
           : f->slices == 0                               ? "slices"
           : f->max_slab_slices == 0                      ? "max_slab_slices"
           : f->voxel_type == 0                           ? "voxel_type"
           : f->carrier == 0                              ? "carrier"
           : f->carrier != SV_CARRIER_HOST && !host_queue ? "carrier" /* objects need a queue */
           : f->tiles_x == 0                              ? "tiles_x"
           : f->tile_w < f->width                         ? "tile_w"
           : f->tile_h < f->height                        ? "tile_h"
                                                          : NULL;
}

static void pass_format(rec_cursor *c, rec_item *it) {
    sv_format *f = &it->format;
    f->size = sizeof *f;
    PASS_LIMITED(c, f->width, REC_MAX_SIDE);
    PASS_LIMITED(c, f->height, REC_MAX_SIDE);
    PASS_LIMITED(c, f->slices, REC_MAX_SIDE);
    PASS_LIMITED(c, f->max_slab_slices, REC_MAX_SIDE);
    PASS_LIMITED(c, f->voxel_type, SV_VOXEL_U8); /* voxels are packed as bytes */
    PASS_LIMITED(c, f->carrier, SV_CARRIER_IMAGE);
    PASS(c, f->padding_value);
    PASS_LIMITED(c, f->tiles_x, REC_MAX_SIDE);
    PASS_LIMITED(c, f->tile_w, 2 * REC_MAX_SIDE);
    PASS_LIMITED(c, f->tile_h, 2 * REC_MAX_SIDE);
    PASS_LIMITED(c, f->row_pitch, REC_MAX_BYTES);
    PASS(c, f->spacing_mm);
    PASS(c, f->flags);
    PASS_LIMITED(c, it->host_queue, 1);
    PASS_LIMITED(c, it->registered, 1);
    const char *wrong = check_format(f, it->host_queue == 1);
    if (wrong) fail(c, wrong);
    pass_values(c, it);
}

static uint64_t rays(const rec_cursor *c) {
    return c->format ? (uint64_t)c->format->width * c->format->height : 0;
}

static void pass_frame(rec_cursor *c, rec_item *it) {
    sv_frame *f = &it->frame;
    f->size = sizeof *f;
    PASS(c, f->flags);
    PASS(c, f->index);
    PASS(c, f->time_ns);
    PASS(c, f->probe_rotation);
    PASS(c, f->probe_side);
    PASS(c, f->beams);
    PASS(c, f->beam_apex_mm);
    PASS(c, f->beam_sweep_mm);
    pass_values(c, it);
    PASS_LIMITED(c, it->ranges, REC_OBJECT);
    if (it->ranges) pass_data(c, it, rays(c) * sizeof(sv_scanned), "ranges");
}

static void pass_slab(rec_cursor *c, rec_item *it) {
    it->slab.size = sizeof it->slab;
    PASS_LIMITED(c, it->slab.first_slice, REC_MAX_SIDE);
    PASS_LIMITED(c, it->slab.slice_count, REC_MAX_SIDE);
    PASS_LIMITED(c, it->voxels, 1);
    if (it->voxels) pass_data(c, it, rays(c) * it->slab.slice_count, "voxels");
}

static void pass_result(rec_cursor *c, rec_item *it) {
    PASS(c, it->depth_pitch);
    PASS_LIMITED(c, it->depth, REC_OBJECT);
    PASS_LIMITED(c, it->status, 1);
    PASS_LIMITED(c, it->stats, 1);
    if (it->kind == RC_ADJUST) pass_values(c, it);
}

static void pass_call(rec_cursor *c, rec_item *it) {
    PASS_LIMITED(c, it->kind, RC_CALLS - 1);
    PASS_LIMITED(c, it->sound, 1);
    PASS(c, it->ns);
    if (!it->sound) return;
    if (it->kind == RC_ACTIVATE) pass_format(c, it);
    if (it->kind == RC_BEGIN) pass_frame(c, it);
    if (it->kind == RC_SLAB) pass_slab(c, it);
    if (it->kind == RC_END || it->kind == RC_ADJUST) pass_result(c, it);
}

static void pass_return(rec_cursor *c, rec_item *it) {
    PASS_LIMITED(c, it->kind, RC_CALLS - 1);
    PASS_LIMITED(c, it->sound, 1);
    PASS(c, it->ns);
    PASS(c, it->returned);
    PASS_TEXT(c, it->reason);
    if (it->kind != RC_END && it->kind != RC_ADJUST) return;
    PASS_LIMITED(c, it->stats, 1);
    if (it->stats) {
        it->found.size = sizeof it->found;
        PASS(c, it->found.outcome);
        PASS(c, it->found.rays);
        PASS(c, it->found.points);
        PASS(c, it->found.unfilled);
    }
    PASS_LIMITED(c, it->maps, 2);
    if (it->maps > 0) pass_data(c, it, rays(c) * sizeof(float), "depths");
    if (it->maps > 1) pass_data(c, it, rays(c), "status map");
}

void rec_item_pass(rec_cursor *c, rec_item *it) {
    it->bytes = 0;
    if (!c->writes) it->data = NULL;
    switch (it->type) {
    case REC_PLUGIN:
        pass_plugin(c, it);
        break;
    case REC_CALL:
        pass_call(c, it);
        break;
    case REC_RETURN:
        pass_return(c, it);
        break;
    case REC_LOG:
        PASS(c, it->severity);
        PASS_TEXT(c, it->text);
        break;
    case REC_END:
        break;
    default:
        fail(c, "type");
    }
    if (!c->writes && !c->bad && c->at != c->size) fail(c, "length");
}

size_t rec_item_chunk(rec_cursor *c, rec_item *it) {
    uint32_t head[2] = {(uint32_t)it->type, 0};
    c->at = 0;
    c->bad = NULL;
    pass(c, head, sizeof head, "memory");
    rec_item_pass(c, it);
    if (c->at > REC_MAX_BYTES) fail(c, "a part is too large");
    if (c->bad) return 0;
    head[1] = (uint32_t)(c->at - sizeof head);
    memcpy(c->bytes, head, sizeof head);
    uint32_t sum = rec_sum(head[0], c->bytes + sizeof head, head[1]);
    pass(c, &sum, sizeof sum, "memory");
    return c->bad ? 0 : c->at;
}

uint32_t rec_sum(uint32_t type, const uint8_t *bytes, uint32_t length) {
    const uint32_t head[2] = {type, length};
    const uLong sum = crc32(crc32(0, NULL, 0), (const Bytef *)head, sizeof head);
    return (uint32_t)(length ? crc32(sum, bytes, length) : sum);
}
