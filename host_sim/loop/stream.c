/* SPDX-License-Identifier: MIT */
#include "loop/stream.h"

#include <pthread.h>
#include <stdlib.h>

typedef enum { EMPTY, LOADING, READY, FAILED } slot_state;

typedef struct {
    hs_volume volume;
    uint32_t index; /* unless EMPTY */
    slot_state state;
    hs_error error; /* FAILED */
} slot;

struct hs_stream {
    hs_sequence *sequence;
    uint32_t count;
    hs_volume shape; /* the first volume; its voxels are those of a slot */
    slot slots[HS_STREAM_VOLUMES];
    pthread_t thread;
    bool running; /* the thread was started */
    pthread_mutex_t lock;
    pthread_cond_t changed; /* `current`, `stop` or the state of a slot */
    uint32_t current;       /* the volume in use */
    bool stop;
};

/* A volume that is in use or comes soon. */
static bool is_wanted(const hs_stream *s, uint32_t index) {
    return (index + s->count - s->current) % s->count < HS_STREAM_VOLUMES;
}

static slot *find(hs_stream *s, uint32_t index) {
    for (slot *at = s->slots; at < s->slots + HS_STREAM_VOLUMES; at++)
        if (at->state != EMPTY && at->index == index) return at;
    return NULL;
}

static slot *find_room(hs_stream *s) {
    for (slot *at = s->slots; at < s->slots + HS_STREAM_VOLUMES; at++)
        if (at->state == EMPTY || !is_wanted(s, at->index)) return at;
    return NULL;
}

/* A place to read into, with the index to read; NULL: all that is wanted is there. With the lock held. */
static slot *next_to_load(hs_stream *s) {
    for (uint32_t ahead = 0; ahead < HS_STREAM_VOLUMES && ahead < s->count; ahead++) {
        const uint32_t index = (s->current + ahead) % s->count;
        if (find(s, index)) continue;
        slot *room = find_room(s);
        if (room) {
            room->index = index;
            room->state = LOADING;
        }
        return room;
    }
    return NULL;
}

static void load(hs_stream *s, slot *at) {
    at->error = (hs_error){0};
    const bool ok = hs_sequence_read(s->sequence, at->index, &at->volume, &at->error);
    pthread_mutex_lock(&s->lock);
    at->state = ok ? READY : FAILED;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

static void *read_ahead(void *argument) {
    hs_stream *s = argument;
    pthread_mutex_lock(&s->lock);
    while (!s->stop) {
        slot *at = next_to_load(s);
        if (!at) {
            pthread_cond_wait(&s->changed, &s->lock);
            continue;
        }
        pthread_mutex_unlock(&s->lock);
        load(s, at);
        pthread_mutex_lock(&s->lock);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

hs_stream *hs_stream_open(hs_sequence *sequence, hs_error *err) {
    hs_stream *s = calloc(1, sizeof *s);
    if (!s) {
        (void)hs_fail(err, HS_ERR_MEMORY, "sequence: no memory");
        return NULL;
    }
    s->sequence = sequence;
    s->count = hs_sequence_count(sequence);
    (void)pthread_mutex_init(&s->lock, NULL);
    (void)pthread_cond_init(&s->changed, NULL);
    if (hs_sequence_read(s->sequence, 0, &s->slots[0].volume, err)) {
        s->slots[0].state = READY;
        s->shape = s->slots[0].volume;
        s->running = pthread_create(&s->thread, NULL, read_ahead, s) == 0;
        if (s->running) return s;
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no thread to read ahead", s->slots[0].volume.name);
    }
    hs_stream_close(s);
    return NULL;
}

void hs_stream_close(hs_stream *s) {
    if (!s) return;
    if (s->running) {
        pthread_mutex_lock(&s->lock);
        s->stop = true;
        pthread_cond_broadcast(&s->changed);
        pthread_mutex_unlock(&s->lock);
        (void)pthread_join(s->thread, NULL);
    }
    for (uint32_t i = 0; i < HS_STREAM_VOLUMES; i++) hs_volume_free(&s->slots[i].volume);
    (void)pthread_cond_destroy(&s->changed);
    (void)pthread_mutex_destroy(&s->lock);
    free(s);
}

uint32_t hs_stream_count(const hs_stream *stream) {
    return stream->count;
}

const hs_volume *hs_stream_shape(const hs_stream *stream) {
    return &stream->shape;
}

const hs_volume *hs_stream_get(hs_stream *s, uint32_t index, hs_error *err) {
    const hs_volume *volume = NULL;
    pthread_mutex_lock(&s->lock);
    s->current = index;
    pthread_cond_broadcast(&s->changed);
    slot *at = find(s, index);
    while (!at || at->state == LOADING) {
        pthread_cond_wait(&s->changed, &s->lock);
        at = find(s, index);
    }
    if (at->state == READY) {
        volume = &at->volume;
    } else {
        (void)hs_fail(err, at->error.code, "%s", at->error.text);
        at->state = EMPTY; /* the next call tries again */
    }
    pthread_mutex_unlock(&s->lock);
    return volume;
}
