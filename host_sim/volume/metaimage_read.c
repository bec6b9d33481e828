/* SPDX-License-Identifier: MIT */
/* Volumes from MetaImage files: their range, what becomes of their numbers, and one or all of a sequence. */
#include "core/threads.h"
#include "volume/levels.h"
#include "volume/metaimage.h"
#include "volume/metaimage_parts.h"
#include "volume/volume.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The level of each of `count` bit patterns of `width` bytes, 1 or 2, in this machine's order. */
static void look_up(const uint8_t *table, const uint8_t *raw, uint32_t width, size_t count, uint8_t *out) {
    for (size_t i = 0; width == 1 && i < count; i++) out[i] = table[raw[i]];
    for (size_t i = 0; width == 2 && i < count; i++) {
        uint16_t pattern;
        memcpy(&pattern, raw + 2 * i, sizeof pattern);
        out[i] = table[pattern];
    }
}

struct hs_metaimage {
    const char *path;
    hs_metaimage_options options;
    hs_error *err;
    hs_met_voxels *voxels;
    const hs_met_header *header;
    hs_levels levels; /* what becomes 0 and 255, unless the bytes are taken as they are */
    uint8_t
        *table; /* of types of one or two bytes that are mapped: the level of every bit pattern; else NULL */
    double *maps;     /* of what was scanned, or NULL */
    uint32_t valid;   /* volumes whose image is one */
    uint32_t *frames; /* where those are in the file, invalid ones included */
};

static size_t volume_voxels(const hs_met_header *h) {
    return (size_t)h->size[0] * h->size[1] * h->size[2];
}

static bool is_invalid(const hs_met_header *h, uint32_t frame) {
    return h->fields && h->fields[frame].invalid;
}

static size_t chunk_of(size_t left) {
    return left < HS_MET_CHUNK ? left : HS_MET_CHUNK;
}

/* ------------------------------------------------------------------------------------------ the range -- */

/* One pass over the voxels of a volume; blocks of them come in any order. */
typedef struct {
    hs_metaimage *file;
    uint64_t first; /* voxel of the file */
    size_t count;
    pthread_mutex_t lock;
    hs_levels found; /* with the lock held */
} search;

enum { BLOCK = 8 * HS_MET_CHUNK };

/* Of voxels `at` on: 1 for those between the maps of what was scanned. */
static const uint8_t *between(const hs_metaimage *m, uint64_t at, size_t count, uint8_t *out) {
    const uint64_t pixels = (uint64_t)m->header->size[0] * m->header->size[1];
    if (!m->maps) return NULL;
    for (size_t i = 0; i < count; i++) {
        const uint64_t pixel = (at + i) % pixels, z = (at + i) / pixels;
        out[i] = m->maps[pixel] <= (double)z && (double)z < m->maps[pixels + pixel];
    }
    return out;
}

static bool search_block(void *context, uint32_t block, hs_error *err) {
    search *s = context;
    const hs_metaimage *m = s->file;
    const size_t start = (size_t)block * BLOCK, end = s->count - start < BLOCK ? s->count : start + BLOCK;
    hs_levels found = m->levels;
    uint8_t scanned[HS_MET_CHUNK];
    hs_met_room room;
    for (size_t at = start; at < end; at += HS_MET_CHUNK) {
        const size_t n = chunk_of(end - at);
        if (!hs_met_voxels_read_at(m->voxels, s->first + at, n, &room, err)) return false;
        hs_levels_widen(&found, room.value, between(m, at, n, scanned), n);
    }
    pthread_mutex_lock(&s->lock);
    s->found.low = found.low < s->found.low ? found.low : s->found.low;
    s->found.high = found.high > s->found.high ? found.high : s->found.high;
    s->found.gaps |= found.gaps;
    pthread_mutex_unlock(&s->lock);
    return true;
}

static bool read_values(void *context, uint64_t at, size_t count, double *out, hs_error *err) {
    const hs_metaimage *m = context;
    hs_met_room room;
    if (!hs_met_voxels_read_at(m->voxels, m->frames[0] * (uint64_t)volume_voxels(m->header) + at, count,
                               &room, err))
        return false;
    memcpy(out, room.value, count * sizeof *out);
    return true;
}

/* Reads all the data once for the smallest and largest value: one mapping serves the whole sequence. */
static bool find_range(hs_metaimage *m) {
    const size_t count = volume_voxels(m->header);
    search s = {.file = m, .count = count, .found = m->levels};
    (void)pthread_mutex_init(&s.lock, NULL);
    bool ok = true;
    for (uint32_t i = 0; ok && i < m->valid; i++) {
        s.first = (uint64_t)m->frames[i] * count;
        ok = hs_parallel_try(hs_met_voxels_threads(m->voxels), (uint32_t)((count + BLOCK - 1) / BLOCK),
                             search_block, &s, m->err);
    }
    (void)pthread_mutex_destroy(&s.lock);
    if (!ok || !hs_met_voxels_finish(m->voxels, m->err)) return false;
    m->levels = s.found;
    if (m->options.has_window) {
        m->levels.low = m->options.window_low;
        m->levels.high = m->options.window_high;
    }
    return true;
}

static bool check_range(const hs_metaimage *m) {
    char what[512];
    (void)snprintf(what, sizeof what, "%s:%u: ElementDataFile '%s'", m->path, m->header->data_line,
                   m->header->data_name);
    return hs_levels_check(&m->levels, what, m->err);
}

/* -------------------------------------------------------------------------------------------- a volume -- */

/* 8 bits stay as they are; of those with a constant outside, that becomes 0 and a 0 becomes 1. */
static bool takes_bytes(const hs_metaimage *m) {
    return m->header->type == HS_MET_UCHAR && !m->options.has_window && !m->levels.has_outside;
}

/* What the range of the values must be found for, or whether some are no numbers. */
static bool needs_search(const hs_metaimage *m) {
    const hs_met_type type = m->header->type;
    return type == HS_MET_FLOAT || type == HS_MET_DOUBLE || (!m->options.has_window && type != HS_MET_UCHAR);
}

/* There are few values of one or two bytes: each is mapped once. */
static bool make_table(hs_metaimage *m) {
    enum { PATTERNS = 1 << 16 };
    const uint32_t width = m->header->element_bytes, count = width == 1 ? 256 : PATTERNS;
    if (width > 2) return true;
    m->table = hs_memory(1, count, m->path, m->err);
    if (!m->table) return false;
    for (uint32_t first = 0; first < count; first += 256) {
        uint8_t raw[512];
        double value[256];
        for (uint32_t i = 0; i < 256; i++) {
            const uint16_t pattern = (uint16_t)(first + i);
            if (width == 1) raw[i] = (uint8_t)i;
            if (width == 2) memcpy(raw + 2 * (size_t)i, &pattern, sizeof pattern);
        }
        hs_met_decode(m->header->type, raw, 256, value);
        hs_levels_of(&m->levels, value, 256, m->table + first);
    }
    return true;
}

/* A volume on its way from the file. */
typedef struct {
    hs_metaimage *file;
    uint64_t first; /* voxel of the file */
} reading;

/* Maps low .. high to 0 .. 255. */
static bool read_mapped(const reading *r, size_t first, size_t count, uint8_t *out, hs_error *err) {
    const hs_metaimage *m = r->file;
    hs_met_room room;
    for (size_t at = 0; at < count; at += HS_MET_CHUNK) {
        const size_t n = chunk_of(count - at);
        const uint64_t voxel = r->first + first + at;
        if (!(m->table ? hs_met_voxels_raw_at : hs_met_voxels_read_at)(m->voxels, voxel, n, &room, err))
            return false;
        if (m->table)
            look_up(m->table, room.raw, m->header->element_bytes, n, out + at);
        else
            hs_levels_of(&m->levels, room.value, n, out + at);
    }
    return true;
}

static bool read_piece(void *context, size_t first, size_t count, uint8_t *out, hs_error *err) {
    const reading *r = context;
    const hs_metaimage *m = r->file;
    const bool ok = takes_bytes(m) ? hs_met_voxels_bytes_at(m->voxels, r->first + first, count, out, err)
                                   : read_mapped(r, first, count, out, err);
    if (ok && m->options.padding == HS_PADDING_NONE) hs_raise_zeros(out, count);
    return ok;
}

void hs_metaimage_shape(const hs_metaimage *m, hs_volume *shape) {
    const hs_met_header *h = m->header;
    *shape = (hs_volume){.nx = h->size[0], .ny = h->size[1], .nz = h->size[2], .pose = h->pose};
    const bool given = m->options.has_spacing;
    memcpy(shape->spacing, given ? m->options.spacing : h->spacing, sizeof h->spacing);
    shape->spacing_unsaid = !given && !h->spacing_stated;
    if (m->options.has_probe || h->probe_stated)
        hs_volume_scanned_from(shape, m->options.has_probe ? m->options.probe : h->probe);
    shape->apex_said = h->apex_said && !given && shape->probe == h->probe;
    memcpy(shape->apex, h->apex, sizeof shape->apex);
    const char *slash = strrchr(m->path, '/');
    (void)snprintf(shape->name, sizeof shape->name, "%s", slash ? slash + 1 : m->path);
}

/* Allocates the volume the header describes, named after the file. */
static bool make_volume(const hs_metaimage *m, hs_volume *out) {
    const hs_met_header *h = m->header;
    hs_error cause = {0};
    if (!hs_volume_init(out, h->size[0], h->size[1], h->size[2], &cause))
        return hs_fail(m->err, cause.code, "%s:%u: DimSize: %s", m->path, h->dim_line, cause.text);
    uint8_t *voxels = out->voxels;
    hs_metaimage_shape(m, out);
    out->voxels = voxels;
    return true;
}

/* ---------------------------------------------------------------------------------------- the file -- */

static bool check_window(const char *path, const hs_metaimage_options *o, hs_error *err) {
    const bool is_window =
        isfinite(o->window_low) && isfinite(o->window_high) && o->window_low < o->window_high;
    return !o->has_window || is_window ||
           hs_fail(err, HS_ERR_USAGE, "%s: window is %g .. %g, expected two finite numbers, low < high", path,
                   o->window_low, o->window_high);
}

static bool start(hs_metaimage *m) {
    m->voxels = hs_met_voxels_open(m->path, m->options.folder, m->err);
    if (!m->voxels) return false;
    m->header = hs_met_voxels_header(m->voxels);
    hs_met_voxels_allow_gaps(m->voxels);
    m->frames = hs_memory(m->header->frames, sizeof *m->frames, m->path, m->err);
    if (!m->frames) return false;
    for (uint32_t frame = 0; frame < m->header->frames; frame++)
        if (!is_invalid(m->header, frame)) m->frames[m->valid++] = frame;
    if (m->valid == 0)
        return hs_fail(m->err, HS_ERR_INPUT, "%s: ImageStatus is INVALID for every volume", m->path);
    if (m->options.scanned[0]) {
        hs_volume shape;
        hs_metaimage_shape(m, &shape);
        m->maps = hs_scanned_maps_load(&shape, m->options.scanned[0], m->options.scanned[1], m->err);
        if (!m->maps) return false;
    }
    hs_levels_begin(&m->levels);
    const bool plain = m->header->type == HS_MET_UCHAR && !m->options.has_window;
    if (m->options.padding == HS_PADDING_AUTO && !m->maps &&
        !hs_levels_find_outside(&m->levels, m->header->size, plain, read_values, m, m->err))
        return false;
    m->levels.low = plain ? 0.0 : m->options.has_window ? m->options.window_low : m->levels.low;
    m->levels.high = plain ? 255.0 : m->options.has_window ? m->options.window_high : m->levels.high;
    if (takes_bytes(m)) return true;
    return (!needs_search(m) || find_range(m)) && check_range(m) && make_table(m);
}

hs_metaimage *hs_metaimage_open(const char *path, const hs_metaimage_options *opt, hs_error *err) {
    const hs_metaimage_options defaults = {0};
    if (!opt) opt = &defaults;
    if (!check_window(path, opt, err)) return NULL;
    hs_metaimage *m = hs_memory(1, sizeof *m, path, err);
    if (!m) return NULL;
    *m = (hs_metaimage){.path = path, .options = *opt, .err = err};
    if (start(m)) return m;
    hs_metaimage_close(m);
    return NULL;
}

uint32_t hs_metaimage_volumes(const hs_metaimage *file) {
    return file->valid;
}

uint32_t hs_metaimage_left_out(const hs_metaimage *file) {
    return file->header->frames - file->valid;
}

bool hs_metaimage_range(const hs_metaimage *file, double *low, double *high) {
    *low = file->levels.low;
    *high = file->levels.high;
    return !takes_bytes(file);
}

const hs_levels *hs_metaimage_levels(const hs_metaimage *file) {
    return &file->levels;
}

const hs_frame_fields *hs_metaimage_fields(const hs_metaimage *file, uint32_t index) {
    return file->header->fields ? &file->header->fields[file->frames[index]] : NULL;
}

/* The voxels of volume `index`, and behind those of the last one that the data ends. */
static bool fill(hs_metaimage *m, uint32_t index, hs_volume *out) {
    reading r = {.file = m, .first = (uint64_t)m->frames[index] * hs_volume_count(out)};
    const uint32_t threads = hs_met_voxels_threads(m->voxels);
    /* Of values that are no numbers the file says itself what was not scanned: no zero is a guess. */
    const bool guess = m->options.padding == HS_PADDING_AUTO && !m->levels.gaps && !m->maps;
    const bool ok = hs_volume_fill(out, threads, read_piece, &r, m->err) &&
                    (!guess || hs_levels_mark_unscanned(&m->levels, out, m->err));
    if (ok && m->maps) hs_scanned_maps_mark(out, m->maps);
    return ok && (index + 1 < m->valid || hs_met_voxels_finish(m->voxels, m->err));
}

static bool read_volume(hs_metaimage *m, uint32_t index, hs_volume *volume) {
    const bool fresh = volume->voxels == NULL;
    if (fresh && !make_volume(m, volume)) return false;
    const bool ok = fill(m, index, volume);
    if (!ok && fresh) hs_volume_free(volume);
    return ok;
}

bool hs_metaimage_read_at(hs_metaimage *file, uint32_t index, hs_volume *volume, hs_error *err) {
    file->err = err;
    return read_volume(file, index, volume);
}

void hs_metaimage_close(hs_metaimage *file) {
    if (!file) return;
    hs_met_voxels_close(file->voxels);
    free(file->frames);
    free(file->table);
    free(file->maps);
    free(file);
}

bool hs_metaimage_read(const char *path, const hs_metaimage_options *opt, hs_volume *out, hs_error *err) {
    memset(out, 0, sizeof *out);
    hs_metaimage *m = hs_metaimage_open(path, opt, err);
    if (!m) return false;
    bool ok =
        m->header->frames == 1 || hs_fail(err, HS_ERR_INPUT,
                                          "%s:%u: DimSize is %s: a sequence of %u volumes, expected one "
                                          "volume",
                                          path, m->header->dim_line, m->header->size_text, m->header->frames);
    ok = ok && read_volume(m, 0, out);
    hs_metaimage_close(m);
    return ok;
}
