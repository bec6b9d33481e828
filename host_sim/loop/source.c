/* SPDX-License-Identifier: MIT */
#include "loop/source.h"

#include "core/progress.h"
#include "loop/sequence.h"
#include "volume/fan_fit.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STREAM_VOLUMES 3u /* in memory at most: the one in use, and the two that come next */

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
    slot slots[STREAM_VOLUMES];
    pthread_t thread;
    bool running; /* the thread was started */
    pthread_mutex_t lock;
    pthread_cond_t changed; /* `current`, `stop` or the state of a slot */
    uint32_t current;       /* the volume in use */
    bool stop;
};

/* A volume that is in use or comes soon. */
static bool is_wanted(const hs_stream *s, uint32_t index) {
    return (index + s->count - s->current) % s->count < STREAM_VOLUMES;
}

static slot *find_slot(hs_stream *s, uint32_t index) {
    for (slot *at = s->slots; at < s->slots + STREAM_VOLUMES; at++)
        if (at->state != EMPTY && at->index == index) return at;
    return NULL;
}

static slot *find_room(hs_stream *s) {
    for (slot *at = s->slots; at < s->slots + STREAM_VOLUMES; at++)
        if (at->state == EMPTY || !is_wanted(s, at->index)) return at;
    return NULL;
}

/* A place to read into, with the index to read; NULL: all that is wanted is there. With the lock held. */
static slot *next_to_load(hs_stream *s) {
    for (uint32_t ahead = 0; ahead < STREAM_VOLUMES && ahead < s->count; ahead++) {
        const uint32_t index = (s->current + ahead) % s->count;
        if (find_slot(s, index)) continue;
        slot *room = find_room(s);
        if (room) {
            room->index = index;
            room->state = LOADING;
        }
        return room;
    }
    return NULL;
}

static void load_slot(hs_stream *s, slot *at) {
    at->error = (hs_error){0};
    const bool ok = hs_sequence_read(s->sequence, at->index, &at->volume, &at->error);
    if (ok) hs_volume_share_beams(&at->volume, &s->shape);
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
        load_slot(s, at);
        pthread_mutex_lock(&s->lock);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

/* Waits for the thread. NULL is allowed. */
static void hs_stream_close(hs_stream *s) {
    if (!s) return;
    if (s->running) {
        pthread_mutex_lock(&s->lock);
        s->stop = true;
        pthread_cond_broadcast(&s->changed);
        pthread_mutex_unlock(&s->lock);
        (void)pthread_join(s->thread, NULL);
    }
    for (uint32_t i = 0; i < STREAM_VOLUMES; i++) hs_volume_free(&s->slots[i].volume);
    (void)pthread_cond_destroy(&s->changed);
    (void)pthread_mutex_destroy(&s->lock);
    free(s);
}

/* Reads the first volume and starts the thread, which has the sequence to itself until hs_stream_close; it
 * must outlive the stream. NULL with the errors of hs_sequence_read, or HS_ERR_MEMORY. */
static hs_stream *hs_stream_open(hs_sequence *sequence, hs_error *err) {
    hs_stream *s = hs_memory(1, sizeof *s, "sequence", err);
    if (!s) return NULL;
    s->sequence = sequence;
    s->count = hs_sequence_count(sequence);
    (void)pthread_mutex_init(&s->lock, NULL);
    (void)pthread_cond_init(&s->changed, NULL);
    if (hs_sequence_read(s->sequence, 0, &s->slots[0].volume, err)) {
        s->slots[0].state = READY;
        (void)hs_volume_find_beams(&s->slots[0].volume, NULL);
        s->shape = s->slots[0].volume;
        s->running = pthread_create(&s->thread, NULL, read_ahead, s) == 0;
        if (s->running) return s;
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no thread to read ahead", s->slots[0].volume.name);
    }
    hs_stream_close(s);
    return NULL;
}

/* Size, spacing and geometry of all its volumes, pose and name of the first. Its voxels may be those of any:
 * do not read them. */
static const hs_volume *hs_stream_shape(const hs_stream *stream) {
    return &stream->shape;
}

/* Volume `index` (0 .. count - 1), which stays as it is until the next call; waits if it is still on its way.
 * Those that follow it, and after the last one the first, are then read ahead. The voxels lie in one of
 * STREAM_VOLUMES places in turn. NULL with the errors of hs_sequence_read. One thread at a time. */
static const hs_volume *hs_stream_get(hs_stream *s, uint32_t index, hs_error *err) {
    const hs_volume *volume = NULL;
    pthread_mutex_lock(&s->lock);
    s->current = index;
    pthread_cond_broadcast(&s->changed);
    slot *at = find_slot(s, index);
    while (!at || at->state == LOADING) {
        pthread_cond_wait(&s->changed, &s->lock);
        at = find_slot(s, index);
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

/* The only volume of the sequence. */
static bool read_one(hs_source *source, hs_error *err) {
    source->file = calloc(1, sizeof *source->file);
    source->volumes = calloc(1, sizeof *source->volumes);
    if (!source->file || !source->volumes) return hs_fail(err, HS_ERR_MEMORY, "source: no memory");
    source->volumes[0] = source->file;
    const bool ok = hs_sequence_read(source->sequence, 0, source->file, err);
    if (ok) (void)hs_volume_find_beams(source->file, NULL);
    hs_sequence_stop_reading(source->sequence);
    return ok;
}

bool hs_source_open_files(hs_source *source, const char *const *paths, uint32_t count,
                          const hs_source_files *how, hs_error *err) {
    const hs_source_files defaults = {0};
    if (!how) how = &defaults;
    *source = (hs_source){0};
    if (count == 0) return hs_fail(err, HS_ERR_USAGE, "no volume given");
    source->sequence = hs_sequence_open(paths, count, how, err);
    if (!source->sequence) return false;
    source->count = hs_sequence_count(source->sequence);
    source->left_out = hs_sequence_left_out(source->sequence);
    if (source->count > 1) source->stream = hs_stream_open(source->sequence, err);
    const bool ok = source->count > 1 ? source->stream != NULL : read_one(source, err);
    if (!ok) hs_source_close(source);
    return ok;
}

/* Memory for `count` volumes of a scene. */
static bool allocate_scenes(hs_source *source, uint32_t count, hs_error *err) {
    *source = (hs_source){.count = count};
    source->volumes = calloc(count, sizeof *source->volumes);
    source->truths = calloc(count, sizeof *source->truths);
    source->scenes = calloc(count, sizeof *source->scenes);
    return (source->volumes && source->truths && source->scenes) ||
           hs_fail(err, HS_ERR_MEMORY, "scene: no memory for %u volumes", count);
}

bool hs_source_open_scene(hs_source *source, const hs_source_scene *what, hs_error *err) {
    *source = (hs_source){0};
    hs_scene *scene = hs_scene_open(what->name, err);
    if (!scene) return false;
    bool ok = allocate_scenes(source, what->volumes, err);
    hs_progress progress;
    hs_progress_begin(&progress, "generating the scene", what->volumes);
    for (uint32_t i = 0; ok && i < what->volumes; i++) {
        const hs_scene_options options = {
            .size = what->size, .seed = what->seed, .frame = i, .real = what->real, .lean = true};
        ok = hs_scene_frame(scene, &options, &source->scenes[i], err);
        source->volumes[i] = &source->scenes[i].full;
        source->truths[i] = &source->scenes[i].truth;
        if (what->volumes > 1) hs_progress_step(&progress, i + 1u);
    }
    hs_progress_end(&progress);
    if (ok) (void)snprintf(source->title, sizeof source->title, "%s", hs_scene_title(scene));
    hs_scene_close(scene);
    if (!ok) hs_source_close(source);
    return ok;
}

static void free_cropped(hs_source *source) {
    for (int i = 0; source->cropped && i < 2; i++) free(source->cropped[i].volume.voxels);
    free(source->cropped);
    source->cropped = NULL;
}

void hs_source_close(hs_source *source) {
    for (uint32_t i = 0; source->scenes && i < source->count; i++) hs_scene_free(&source->scenes[i]);
    hs_stream_close(source->stream);
    hs_sequence_close(source->sequence);
    if (source->file) hs_volume_free(source->file);
    free_cropped(source);
    free(source->file);
    free(source->scenes);
    free(source->truths);
    free(source->volumes);
    *source = (hs_source){0};
}

/* ---------------------------------------------------------------------------------------------- crop -- */

static const hs_volume *whole_shape(const hs_source *source) {
    return source->stream ? hs_stream_shape(source->stream) : source->volumes[0];
}

static bool make_room(hs_source *source, hs_error *err) {
    const size_t count = hs_volume_count(whole_shape(source));
    source->cropped = calloc(2, sizeof *source->cropped);
    bool ok = source->cropped != NULL;
    for (int i = 0; ok && i < (source->truths ? 2 : 1); i++)
        ok = (source->cropped[i].volume.voxels = malloc(count)) != NULL;
    if (ok) return true;
    free_cropped(source);
    return hs_fail(err, HS_ERR_MEMORY, "box: no memory for %zu voxels", count);
}

/* All but the voxels. */
static void take_shape(hs_cropped *cropped, const hs_volume *whole) {
    uint8_t *voxels = cropped->volume.voxels;
    cropped->volume = *whole;
    cropped->volume.voxels = voxels;
    cropped->volume.beams = NULL;
    cropped->filled = false;
}

bool hs_source_crop(hs_source *source, const hs_crop *crop, hs_error *err) {
    if (hs_crop_same(crop, &source->crop)) return true;
    if (crop->used && !hs_crop_check(crop, whole_shape(source), err)) return false;
    if (crop->used && !source->cropped && !make_room(source, err)) return false;
    source->crop = *crop;
    source->crops++;
    for (int i = 0; i < 2; i++) take_shape(&source->cropped[i], whole_shape(source));
    return true;
}

static const hs_volume *crop_of(const hs_source *source, const hs_volume *whole, int which, uint32_t index) {
    if (!source->crop.used || !whole || !source->cropped[which].volume.voxels) return whole;
    hs_cropped *cropped = &source->cropped[which];
    if (cropped->filled && cropped->index == index) return &cropped->volume;
    take_shape(cropped, whole);
    memcpy(cropped->volume.voxels, whole->voxels, hs_volume_count(whole));
    hs_crop_apply(&source->crop, whole, cropped->volume.voxels);
    cropped->index = index;
    cropped->filled = true;
    return &cropped->volume;
}

const hs_volume *hs_source_shape(const hs_source *source) {
    return source->crop.used ? &source->cropped[0].volume : whole_shape(source);
}

const hs_volume *hs_source_bring(const hs_source *source, uint32_t index, hs_error *err) {
    const uint32_t at = index % source->count;
    const hs_volume *whole = source->stream ? hs_stream_get(source->stream, at, err) : source->volumes[at];
    return crop_of(source, whole, 0, at);
}

const hs_volume *hs_source_volume(const hs_source *source, uint32_t index) {
    hs_error unused = {0};
    return hs_source_bring(source, index, &unused);
}

const hs_volume *hs_source_truth(const hs_source *source, uint32_t index) {
    const uint32_t at = index % source->count;
    if (source->scenes) hs_scene_fill_truth(&source->scenes[at]);
    return source->truths ? crop_of(source, source->truths[at], 1, at) : NULL;
}

bool hs_source_has_truth(const hs_source *source) {
    return source->truths != NULL;
}

const hs_scene_data *hs_source_scene_data(const hs_source *source, uint32_t index) {
    return source->scenes ? &source->scenes[index % source->count] : NULL;
}

const hs_source_origin *hs_source_origin_of(const hs_source *source, uint32_t index) {
    return source->sequence ? &hs_sequence_origins(source->sequence)[index % source->count] : NULL;
}

bool hs_source_set_truth(hs_source *source, const hs_volume *truth, hs_error *err) {
    const hs_volume **truths = hs_memory(source->count, sizeof *truths, truth->name, err);
    if (!truths) return false;
    truths[0] = truth;
    free(source->truths);
    source->truths = truths;
    return true;
}
