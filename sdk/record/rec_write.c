/* SPDX-License-Identifier: MIT */
#include "record/rec.h"

#include "core/system.h"
#include "record/rec_item.h"
#include "record/rec_ring.h"
#include "smartvis/author_checks.h"

#include <CL/cl.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct rec {
    pthread_mutex_t lock;
    char path[SYS_PATH], part[SYS_PATH + 8];
    pid_t owner; /* a process that the host forks has the file, too, and leaves it alone */
    int file;
    char why[400];
    bool voxels;
    uint64_t end; /* bytes of the file */
    rec_ring ring;
    sv_format format; /* that is active; width 0: none. Its values are gone */
    rec_item item;
    rec_cursor chunk;
    uint8_t *texture; /* of a slab that lies in an object */
    size_t texture_bytes;
};

static bool is_fork(const rec *r) {
    return r->owner != getpid();
}

static void stop(rec *r, const char *what) {
    if (r->why[0]) return;
    (void)snprintf(r->why, sizeof r->why, "%.200s: the recording ends here: %.80s", r->path, what);
}

/* ---- the file */
static void put(rec *r, const void *data, size_t bytes) {
    if (r->why[0]) return;
    if (!rec_write_all(r->file, data, bytes)) {
        stop(r, strerror(errno));
        if (ftruncate(r->file, (off_t)r->end) != 0) return; /* a half chunk is found by whoever reads it */
    } else {
        r->end += bytes;
    }
}

/* A chunk in one piece, so that what is in the file is whole whenever the process ends. */
static void put_item(rec *r) {
    rec_cursor *c = &r->chunk;
    c->format = &r->format;
    r->item.bytes = 0;
    const size_t bytes = rec_item_chunk(c, &r->item);
    if (bytes)
        put(r, c->bytes, bytes);
    else
        stop(r, c->bad);
}

/* ---- the ring */
/* Leaves the last frames in the file, with what the first of them needs. */
static void drop_frames(rec *r) {
    /* A system may rename no file that is open, nor over one. */
    const int to = sys_open(r->part, SYS_NEW);
    bool ok = to >= 0 && rec_ring_copy(&r->ring, r->file, to, r->end);
    ok = (to < 0 || close(to) == 0) && ok;
    if (ok && close(r->file) == 0) {
        ok = sys_replace(r->part, r->path);
        const int why = errno;
        r->file = sys_open(r->path, SYS_MORE);
        if (!ok) errno = why;
    }
    if (!ok || r->file < 0 || lseek(r->file, 0, SEEK_END) < 0) {
        stop(r, strerror(errno));
        if (!ok) (void)sys_remove(r->part);
        return;
    }
    r->end = rec_ring_forget(&r->ring, r->end);
}

static void note_frame(rec *r, bool same) {
    if (rec_ring_is_full(&r->ring)) drop_frames(r);
    if (!r->why[0]) rec_ring_frame(&r->ring, r->end, same);
}

/* ---- what a call is given */
static void take_values(rec *r, const sv_param_value *values, uint32_t count) {
    if (count > REC_MAX_VALUES) stop(r, "more values than a recording holds");
    r->item.value_count = count > REC_MAX_VALUES ? 0 : count;
    if (r->item.value_count) memcpy(r->item.values, values, r->item.value_count * sizeof *values);
}

static void take_format(rec *r, const sv_format *f) {
    r->item.format = *f;
    r->item.host_queue = f->queue != NULL;
    r->item.registered = f->host_memory != NULL;
    take_values(r, f->values, f->value_count);
}

/* Returns room for so many bytes of what lies in objects, or NULL. */
static uint8_t *room(rec *r, size_t bytes) {
    if (r->texture_bytes >= bytes) return r->texture;
    uint8_t *grown = realloc(r->texture, bytes);
    if (!grown) {
        stop(r, "no memory");
        return NULL;
    }
    r->texture = grown;
    r->texture_bytes = bytes;
    return grown;
}

static bool read_object(rec *r, cl_mem object, size_t offset, size_t bytes, void *to) {
    if (clEnqueueReadBuffer(r->format.queue, object, CL_TRUE, offset, bytes, to, 0, NULL, NULL) == CL_SUCCESS)
        return true;
    stop(r, "an OpenCL buffer cannot be read");
    return false;
}

static void take_frame(rec *r, const sv_frame *f) {
    const size_t bytes = (size_t)r->format.width * r->format.height * sizeof(sv_scanned);
    sv_frame *to = &r->item.frame;
    memset(to, 0, sizeof *to); /* what an older host does not say */
    memcpy(to, f, f->size < sizeof *to ? f->size : sizeof *to);
    take_values(r, f->values, f->value_count);
    r->item.ranges = f->scanned ? REC_MEMORY : f->scanned_object ? REC_OBJECT : REC_ABSENT;
    if (r->item.ranges == REC_ABSENT) return;
    r->item.data = room(r, bytes);
    if (!r->item.data) return;
    if (f->scanned)
        memcpy(r->item.data, f->scanned, bytes);
    else
        (void)read_object(r, f->scanned_object, f->scanned_offset, bytes, r->item.data);
}

/* Brings the texture of a slab to the host: memory, and from one of its rows to the next. */
static const uint8_t *texture_of(rec *r, const sv_slab *slab, size_t voxels, size_t *pitch) {
    const sv_format *f = &r->format;
    *pitch = f->row_pitch;
    if (f->carrier == SV_CARRIER_HOST) return slab->memory;
    if (f->carrier == SV_CARRIER_BUFFER) {
        const size_t bytes = (size_t)sva_slab_bytes(f, slab->slice_count);
        uint8_t *to = room(r, voxels + bytes);
        return to && read_object(r, slab->object, slab->offset, bytes, to + voxels) ? to + voxels : NULL;
    }
    const size_t tile_rows = (slab->slice_count + f->tiles_x - 1) / f->tiles_x, origin[3] = {0, 0, 0};
    const size_t size[3] = {(size_t)f->tiles_x * f->tile_w, (tile_rows - 1) * f->tile_h + f->height, 1};
    uint8_t *to = room(r, voxels + size[0] * size[1]);
    *pitch = size[0];
    if (!to) return NULL;
    if (clEnqueueReadImage(f->queue, slab->object, CL_TRUE, origin, size, size[0], 0, to + voxels, 0, NULL,
                           NULL) == CL_SUCCESS)
        return to + voxels;
    stop(r, "an OpenCL image cannot be read");
    return NULL;
}

static void take_slab(rec *r, const sv_slab *slab) {
    const sv_format *f = &r->format;
    const size_t slice = (size_t)f->width * f->height, voxels = slice * slab->slice_count;
    size_t pitch = 0;
    r->item.slab = *slab;
    r->item.voxels = r->voxels;
    if (!r->voxels) return;
    const uint8_t *from = texture_of(r, slab, voxels, &pitch);
    uint8_t *to = from ? room(r, voxels) : NULL;
    if (!to) return;
    r->item.data = to;
    for (uint32_t s = 0; s < slab->slice_count; s++)
        for (uint32_t y = 0; y < f->height; y++)
            memcpy(to + s * slice + (size_t)y * f->width,
                   from + ((size_t)(s / f->tiles_x) * f->tile_h + y) * pitch +
                       (size_t)(s % f->tiles_x) * f->tile_w,
                   f->width);
}

static void take_result(rec *r, const sv_result *result) {
    r->item.depth_pitch = result->depth_pitch;
    r->item.depth = result->depth ? REC_MEMORY : REC_OBJECT;
    r->item.status = result->status != NULL;
    r->item.stats = result->stats != NULL;
}

void rec_before(rec *r, const rc_call *call) {
    if (is_fork(r)) return;
    (void)pthread_mutex_lock(&r->lock);
    rec_item *it = &r->item;
    it->type = REC_CALL;
    it->kind = (uint32_t)call->kind;
    it->ns = call->start_ns;
    /* What needs a format that is not there is out of turn: its state says all. */
    const bool active = r->format.width > 0;
    it->sound = call->kind <= RC_DESTROY || (call->kind == RC_ACTIVATE && call->sound) ||
                (call->kind == RC_DEACTIVATE && active) || (call->sound && active);
    it->data = NULL;
    if (call->kind == RC_BEGIN) note_frame(r, it->sound && (call->frame->flags & SV_FRAME_SAME_VOLUME) != 0);
    if (call->kind == RC_ACTIVATE) rec_ring_activation(&r->ring, r->end);
    if (it->sound && call->kind == RC_ACTIVATE) take_format(r, call->format);
    if (it->sound && call->kind == RC_BEGIN) take_frame(r, call->frame);
    if (it->sound && call->kind == RC_SLAB) take_slab(r, call->slab);
    if (it->sound && call->kind == RC_END) take_result(r, call->result);
    if (it->sound && call->kind == RC_ADJUST) {
        take_result(r, call->result);
        take_values(r, call->values, call->value_count);
    }
    if (!r->why[0]) put_item(r);
    (void)pthread_mutex_unlock(&r->lock);
}

/* ---- what came of it */
/* Depths without a pitch, and the status map behind them. */
static void take_maps(rec *r, const sv_result *result) {
    const size_t width = r->format.width, count = width * r->format.height, row = width * sizeof(float);
    uint8_t *to = room(r, count * (sizeof(float) + 1));
    if (!to) return;
    r->item.data = to;
    r->item.maps = result->status ? 2 : 1;
    if (result->depth_object &&
        !read_object(r, result->depth_object, result->depth_offset, count * sizeof(float), to))
        return;
    for (size_t y = 0; result->depth && y < r->format.height; y++)
        memcpy(to + y * row,
               (const char *)result->depth + y * (result->depth_pitch ? result->depth_pitch : row), row);
    if (result->status) memcpy(to + count * sizeof(float), result->status, count);
}

static void take_outcome(rec *r, const rc_call *call) {
    const sv_result *result = call->result;
    if (r->format.queue && clFinish(r->format.queue) != CL_SUCCESS) {
        stop(r, "the host's queue cannot be waited for");
        return;
    }
    r->item.stats = result->stats != NULL;
    if (result->stats) r->item.found = *result->stats;
    if (r->voxels) take_maps(r, result);
}

static void put_plugin(rec *r, const sv_plugin *p) {
    rec_item *it = &r->item;
    it->type = REC_PLUGIN;
    (void)snprintf(it->id, sizeof it->id, "%s", p->descriptor->id);
    (void)snprintf(it->name, sizeof it->name, "%s", p->descriptor->name);
    (void)snprintf(it->version, sizeof it->version, "%s", p->descriptor->version);
    it->param_count = 0;
    const uint32_t told = p->param_count(p);
    for (uint32_t i = 0; i < told && i < REC_MAX_VALUES; i++) {
        sv_param_info info = {.size = sizeof info};
        if (p->param_info(p, i, &info) != SV_OK || !info.key ||
            rec_find_param(it->params, it->param_count, info.id))
            continue;
        rec_param *param = &it->params[it->param_count++];
        *param = (rec_param){.id = info.id, .flags = info.flags};
        (void)snprintf(param->key, sizeof param->key, "%s", info.key);
    }
    put_item(r);
    r->ring.head = r->end;
}

void rec_after(rec *r, const rc_call *call) {
    if (is_fork(r)) return;
    (void)pthread_mutex_lock(&r->lock);
    rec_item *it = &r->item;
    const bool ends = call->kind == RC_END || call->kind == RC_ADJUST;
    it->type = REC_RETURN;
    it->kind = (uint32_t)call->kind;
    it->sound = call->sound;
    it->ns = call->took_ns;
    it->returned = call->status;
    it->stats = it->maps = 0;
    it->data = NULL;
    const char *reason =
        call->plugin && call->status != SV_OK ? call->plugin->last_error(call->plugin) : NULL;
    (void)snprintf(it->reason, sizeof it->reason, "%s", reason ? reason : "");
    if (call->kind == RC_ACTIVATE && call->sound && call->status >= SV_OK) {
        r->format = *call->format;
        r->format.values = NULL;
    }
    if (call->kind == RC_DEACTIVATE) r->format.width = 0;
    if (ends && call->sound && call->status >= SV_OK && r->format.width > 0) take_outcome(r, call);
    if (!r->why[0]) put_item(r);
    if (call->kind == RC_CREATE && call->plugin && !r->why[0]) put_plugin(r, call->plugin);
    if (call->kind == RC_ACTIVATE) rec_ring_activated(&r->ring, r->end);
    (void)pthread_mutex_unlock(&r->lock);
}

void rec_log(rec *r, int32_t severity, const char *text) {
    if (is_fork(r)) return;
    (void)pthread_mutex_lock(&r->lock);
    r->item.type = REC_LOG;
    r->item.severity = severity;
    (void)snprintf(r->item.text, sizeof r->item.text, "%s", text ? text : "");
    if (!r->why[0]) put_item(r);
    (void)pthread_mutex_unlock(&r->lock);
}

/* ---- open, close */
static bool read_options(rec *r, const char *options, char *error, size_t bytes) {
    char word[64];
    int length = 0;
    r->voxels = true;
    for (const char *at = options ? options : ""; *(at += strspn(at, " ,")); at += length) {
        char rest = 0;
        length = (int)strcspn(at, " ,");
        (void)snprintf(word, sizeof word, "%.*s", length < 63 ? length : 63, at);
        if (strcmp(word, "voxels=yes") == 0 || strcmp(word, "voxels=no") == 0)
            r->voxels = word[7] == 'y';
        else if (sscanf(word, "frames=%u%c", &r->ring.keep, &rest) != 1 || r->ring.keep < 1 ||
                 r->ring.keep > 1000000) {
            (void)snprintf(error, bytes,
                           "recording: '%s' is none of frames=N (1 .. 1000000), voxels=yes, voxels=no", word);
            return false;
        }
    }
    return true;
}

/* A recording without its end is what somebody looks for when the process is there again: it gets another
 * name. */
static void keep_unfinished(const char *path) {
    const uint32_t end[3] = {REC_END, 0, rec_sum(REC_END, NULL, 0)};
    char magic[8] = "", last[sizeof end] = "", before[SYS_PATH + 8];
    const int file = sys_open(path, SYS_READ);
    if (file < 0) return;
    const bool is_recording =
        read(file, magic, sizeof magic) == sizeof magic && memcmp(magic, REC_MAGIC, sizeof magic) == 0 &&
        lseek(file, -(off_t)sizeof last, SEEK_END) >= 0 && read(file, last, sizeof last) == sizeof last;
    (void)close(file);
    (void)snprintf(before, sizeof before, "%s.before", path);
    if (is_recording && memcmp(last, end, sizeof end) != 0) (void)sys_replace(path, before);
}

rec *rec_open(const char *path, const char *options, char *error, size_t bytes) {
    const rec_header header = REC_HEADER;
    rec *r = calloc(1, sizeof *r);
    if (!r) {
        (void)snprintf(error, bytes, "recording: no memory");
        return NULL;
    }
    r->chunk.writes = true;
    r->owner = getpid();
    r->file = -1;
    (void)pthread_mutex_init(&r->lock, NULL);
    (void)snprintf(r->path, sizeof r->path, "%s", path);
    (void)snprintf(r->part, sizeof r->part, "%s.part", r->path);
    bool ok = read_options(r, options, error, bytes);
    if (ok && r->ring.keep)
        ok = (r->ring.frames = calloc(2 * (size_t)r->ring.keep, sizeof *r->ring.frames)) != NULL;
    if (ok) {
        keep_unfinished(path);
        r->file = sys_open(path, SYS_NEW);
        if (r->file >= 0) put(r, &header, sizeof header);
        ok = r->file >= 0 && !r->why[0];
        if (!ok) (void)snprintf(error, bytes, "recording: %s: %s", path, strerror(errno));
    }
    if (ok) return r;
    rec_close(r);
    return NULL;
}

const char *rec_why(const rec *r) {
    return r->why;
}

void rec_close(rec *r) {
    if (!r) return;
    if (is_fork(r)) stop(r, "it is another process's");
    if (r->file >= 0 && !r->why[0] && r->ring.keep && r->ring.count > r->ring.keep) drop_frames(r);
    if (r->file >= 0 && !r->why[0]) {
        r->item.type = REC_END;
        put_item(r);
    }
    if (r->file >= 0) (void)close(r->file);
    (void)pthread_mutex_destroy(&r->lock);
    free(r->ring.frames);
    free(r->texture);
    free(r->chunk.bytes);
    free(r);
}
