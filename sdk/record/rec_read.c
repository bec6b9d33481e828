/* SPDX-License-Identifier: MIT */
#include "core/system.h"
#include "record/rec_item.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NO_FRAME UINT32_MAX /* of no slab that can be read */

struct rec_reader {
    FILE *file;
    char path[1024];
    uint64_t at, size; /* bytes read, bytes of the file */
    uint32_t open;     /* 1 + the kind of the call under way; 0: none */
    bool sound, met;   /* that call is sound; the plugin has been described */
    sv_format format;  /* that is active; width 0: none */
    sv_format asked;   /* of the activate under way */
    uint32_t next;     /* the slice that the next slab begins with; NO_FRAME */
    uint8_t *chunk;
    uint8_t *data; /* of the last item */
};

/* The last word of a C expression: the field. */
static const char *field_of(const char *expression) {
    const char *last = expression;
    for (const char *c = expression; *c; c++)
        if (*c == '.' || *c == '>') last = c + 1;
    return last;
}

static bool take(rec_reader *r, void *to, size_t bytes) {
    if (bytes > r->size - r->at || fread(to, 1, bytes, r->file) != bytes) return false;
    r->at += bytes;
    return true;
}

rec_reader *rec_reader_open(const char *path, char *error, size_t bytes) {
    rec_header header;
    rec_reader *r = calloc(1, sizeof *r);
    if (!r) {
        (void)snprintf(error, bytes, "%s: no memory", path);
        return NULL;
    }
    r->next = NO_FRAME;
    (void)snprintf(r->path, sizeof r->path, "%s", path);
    const int file = sys_open(path, SYS_READ);
    const off_t size = file < 0 ? -1 : lseek(file, 0, SEEK_END);
    r->file = size < 0 || lseek(file, 0, SEEK_SET) < 0 ? NULL : fdopen(file, "rb");
    if (!r->file) {
        const char *why = errno == EINVAL ? "not a regular file" : strerror(errno);
        (void)snprintf(error, bytes, "%s: %s", path, why);
        if (file >= 0) (void)close(file);
    } else {
        r->size = (uint64_t)size;
        if (!take(r, &header, sizeof header) || memcmp(header.magic, REC_MAGIC, sizeof header.magic) != 0)
            (void)snprintf(error, bytes, "%s: is no recording: it does not begin with %s", path, REC_MAGIC);
        else if (header.version != REC_VERSION)
            (void)snprintf(error, bytes, "%s: version is %u, this program reads %u", path, header.version,
                           REC_VERSION);
        else
            return r;
    }
    rec_reader_close(r);
    return NULL;
}

static int broken(const rec_reader *r, uint64_t at, char *error, size_t bytes, const char *what,
                  const char *of) {
    (void)snprintf(error, bytes, "%s: byte %llu: %s%s", r->path, (unsigned long long)at, what, of);
    return -1;
}

/* What cannot be there now, or NULL. Behind it a sound call has the format that the plugin was activated
 * with, and its slabs come in turn: whoever plays a recording need not ask. */
static const char *check_order(const rec_reader *r, const rec_item *item) {
    const bool active = r->format.width > 0;
    if (item->type == REC_RETURN && r->open != item->kind + 1) return "a return without its call";
    if (item->type == REC_PLUGIN && r->met) return "a second plugin";
    if (item->type != REC_CALL) return NULL;
    if (r->open) return "a call before the return of another one";
    if (!item->sound)
        return item->kind == RC_DEACTIVATE && active
                   ? "a deactivate that counts for nothing, and an activation lasts"
                   : NULL;
    if (item->kind == RC_ACTIVATE && active) return "activate, and an activation lasts";
    if (item->kind >= RC_BEGIN && !active) return "a frame without an activation";
    if (item->kind == RC_SLAB && (item->slab.first_slice != r->next || item->slab.slice_count < 1 ||
                                  item->slab.slice_count > r->format.slices - r->next))
        return "a slab out of turn";
    return NULL;
}

/* The state that what follows is read in. */
static void follow(rec_reader *r, const rec_item *item) {
    const bool call = item->type == REC_CALL;
    r->met |= item->type == REC_PLUGIN;
    if (!call && item->type != REC_RETURN) return;
    r->open = call ? item->kind + 1 : 0;
    if (call) r->sound = item->sound;
    if (item->kind == RC_ACTIVATE && call && item->sound) r->asked = item->format;
    if (item->kind == RC_ACTIVATE && !call && r->sound && item->returned >= SV_OK) r->format = r->asked;
    if (item->kind == RC_DEACTIVATE && !call) r->format = (sv_format){0};
    if (item->kind < RC_BEGIN) r->next = NO_FRAME;
    if (item->kind == RC_BEGIN && call && item->sound) r->next = 0;
    if (item->kind == RC_SLAB && call && item->sound) r->next += item->slab.slice_count;
}

int rec_reader_next(rec_reader *r, rec_item *item, char *error, size_t bytes) {
    const uint64_t start = r->at;
    uint32_t head[2], sum;
    free(r->data);
    r->data = NULL;
    if (r->at == r->size)
        return broken(r, start, error, bytes,
                      "the recording ends without its last part: whoever wrote it ended first", "");
    if (!take(r, head, sizeof head) || head[1] > REC_MAX_BYTES || head[1] + sizeof sum > r->size - r->at)
        return broken(r, start, error, bytes, "the recording is cut off here", "");
    uint8_t *chunk = realloc(r->chunk, head[1] + 1u);
    if (!chunk) return broken(r, start, error, bytes, "no memory for this part", "");
    r->chunk = chunk;
    if (!take(r, chunk, head[1]) || !take(r, &sum, sizeof sum))
        return broken(r, start, error, bytes, "the recording is cut off here", "");
    if (sum != rec_sum(head[0], chunk, head[1]))
        return broken(r, start, error, bytes, "this part is damaged: its checksum is another one", "");
    rec_cursor c = {.bytes = chunk, .size = head[1], .format = &r->format};
    item->type = (rec_type)head[0];
    rec_item_pass(&c, item);
    r->data = item->data;
    if (c.bad) return broken(r, start, error, bytes, "this part cannot be: ", field_of(c.bad));
    const char *out_of_turn = check_order(r, item);
    if (out_of_turn) return broken(r, start, error, bytes, "this part cannot be here: ", out_of_turn);
    follow(r, item);
    if (item->type != REC_END) return 1;
    return r->at == r->size ? 0 : broken(r, r->at, error, bytes, "something follows the last part", "");
}

void rec_reader_close(rec_reader *r) {
    if (!r) return;
    if (r->file) (void)fclose(r->file);
    free(r->chunk);
    free(r->data);
    free(r);
}
