/* SPDX-License-Identifier: MIT */
/* Volumes from MetaImage files: their range, what becomes of their numbers, and one or all of a sequence. */
#include "base/threads.h"
#include "volume/metaimage.h"
#include "volume/metaimage_parts.h"
#include "volume/volume.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 16 }; /* loops of a fixed length, which compilers turn into vectors */

/* Widens low .. high so that it holds `count` finite numbers. */
static void widen(const double *value, size_t count, double *low, double *high) {
    double minimum[LANES], maximum[LANES];
    size_t i = 0;
    for (int k = 0; k < LANES; k++) {
        minimum[k] = *low;
        maximum[k] = *high;
    }
    for (; i + LANES <= count; i += LANES)
        for (int k = 0; k < LANES; k++) {
            const double v = value[i + (size_t)k];
            minimum[k] = v < minimum[k] ? v : minimum[k];
            maximum[k] = v > maximum[k] ? v : maximum[k];
        }
    for (; i < count; i++) {
        minimum[0] = value[i] < minimum[0] ? value[i] : minimum[0];
        maximum[0] = value[i] > maximum[0] ? value[i] : maximum[0];
    }
    for (int k = 0; k < LANES; k++) {
        *low = minimum[k] < *low ? minimum[k] : *low;
        *high = maximum[k] > *high ? maximum[k] : *high;
    }
}

/* Levels for each half of the numbers' unit. Halved, since high - low may exceed the largest double. */
static double scale_of(double low, double high) {
    return 255.0 / (high * 0.5 - low * 0.5);
}

static inline int level_of(double value, double half, double scale) {
    const double level = (value * 0.5 - half) * scale;
    const double clamped = level < 0.0 ? 0.0 : level;
    return (int)((clamped > 255.0 ? 255.0 : clamped) + 0.5);
}

/* low .. high becomes 0 .. 255, rounded to the nearest level; what lies beyond is clamped. */
static void to_levels(const double *value, size_t count, double low, double high, uint8_t *out) {
    const double half = low * 0.5, scale = scale_of(low, high);
    size_t i = 0;
    for (; i + LANES <= count; i += LANES) {
        int level[LANES];
        for (int k = 0; k < LANES; k++) level[k] = level_of(value[i + (size_t)k], half, scale);
        for (int k = 0; k < LANES; k++) out[i + (size_t)k] = (uint8_t)level[k];
    }
    for (; i < count; i++) out[i] = (uint8_t)level_of(value[i], half, scale);
}

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
    double low, high; /* what becomes 0 and 255, unless the bytes are taken as they are */
    uint8_t
        *table; /* of types of one or two bytes that are mapped: the level of every bit pattern; else NULL */
    uint32_t next;    /* the volume that comes next */
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

/* Behind the file's last voxel nothing must follow. */
static bool reach_end(hs_metaimage *m) {
    return hs_met_voxels_seek(m->voxels, (uint64_t)m->header->frames * volume_voxels(m->header)) &&
           hs_met_voxels_finish(m->voxels);
}

/* ------------------------------------------------------------------------------------------ the range -- */

/* One pass over the voxels of a volume; blocks of them come in any order. */
typedef struct {
    hs_metaimage *file;
    uint64_t first; /* voxel of the file */
    size_t count;
    pthread_mutex_t lock;
    double low, high; /* with the lock held */
} search;

enum { BLOCK = 8 * HS_MET_CHUNK };

static bool search_block(void *context, uint32_t block, hs_error *err) {
    search *s = context;
    const size_t start = (size_t)block * BLOCK, end = s->count - start < BLOCK ? s->count : start + BLOCK;
    double low = INFINITY, high = -INFINITY;
    hs_met_room room;
    for (size_t at = start; at < end; at += HS_MET_CHUNK) {
        const size_t n = chunk_of(end - at);
        if (!hs_met_voxels_read_at(s->file->voxels, s->first + at, n, &room, err)) return false;
        widen(room.value, n, &low, &high);
    }
    pthread_mutex_lock(&s->lock);
    widen((const double[]){low, high}, 2, &s->low, &s->high);
    pthread_mutex_unlock(&s->lock);
    return true;
}

#define MAX_VALUE 1e30 /* beyond stand marks and rubbish, which would leave two grey levels of a scan */

/* Reads all the data once for the smallest and largest value: one mapping serves the whole sequence. */
static bool find_range(hs_metaimage *m) {
    const size_t count = volume_voxels(m->header);
    search s = {.file = m, .count = count, .low = INFINITY, .high = -INFINITY};
    (void)pthread_mutex_init(&s.lock, NULL);
    bool ok = true;
    for (uint32_t i = 0; ok && i < m->valid; i++) {
        s.first = (uint64_t)m->frames[i] * count;
        ok = hs_parallel_try(hs_met_voxels_threads(m->voxels), (uint32_t)((count + BLOCK - 1) / BLOCK),
                             search_block, &s, m->err);
    }
    (void)pthread_mutex_destroy(&s.lock);
    if (!ok || !reach_end(m)) return false;
    m->low = s.low;
    m->high = s.high;
    if (m->low < -MAX_VALUE || m->high > MAX_VALUE)
        return hs_fail(
            m->err, HS_ERR_INPUT,
            "%s:%u: ElementDataFile '%s': values are %g .. %g, expected -1e30 .. 1e30; give a window",
            m->path, m->header->data_line, m->header->data_name, m->low, m->high);
    if (m->low < m->high) return true;
    return hs_fail(m->err, HS_ERR_INPUT,
                   "%s:%u: ElementDataFile '%s': every voxel is %g: no range to map to 8 bit, give a window",
                   m->path, m->header->data_line, m->header->data_name, m->low);
}

/* -------------------------------------------------------------------------------------------- a volume -- */

static bool takes_bytes(const hs_metaimage *m) {
    return m->header->type == HS_MET_UCHAR && !m->options.has_window;
}

/* There are few values of one or two bytes: each is mapped once. */
static bool make_table(hs_metaimage *m) {
    enum { PATTERNS = 1 << 16 };
    const uint32_t width = m->header->element_bytes, count = width == 1 ? 256 : PATTERNS;
    if (width > 2) return true;
    m->table = malloc(count);
    if (!m->table) return hs_fail(m->err, HS_ERR_MEMORY, "%s: no memory to map its values", m->path);
    for (uint32_t first = 0; first < count; first += 256) {
        uint8_t raw[512];
        double value[256];
        for (uint32_t i = 0; i < 256; i++) {
            const uint16_t pattern = (uint16_t)(first + i);
            if (width == 1) raw[i] = (uint8_t)i;
            if (width == 2) memcpy(raw + 2 * (size_t)i, &pattern, sizeof pattern);
        }
        hs_met_decode(m->header->type, raw, 256, value);
        to_levels(value, 256, m->low, m->high, m->table + first);
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
            to_levels(room.value, n, m->low, m->high, out + at);
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
    memcpy(shape->spacing, h->spacing, sizeof h->spacing);
    if (m->options.has_probe || h->probe_stated)
        hs_volume_scanned_from(shape, m->options.has_probe ? m->options.probe : h->probe);
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
    m->voxels = hs_met_voxels_open(m->path, m->err);
    if (!m->voxels) return false;
    m->header = hs_met_voxels_header(m->voxels);
    m->frames = calloc(m->header->frames, sizeof *m->frames);
    if (!m->frames)
        return hs_fail(m->err, HS_ERR_MEMORY, "%s: no memory for %u volumes", m->path, m->header->frames);
    for (uint32_t frame = 0; frame < m->header->frames; frame++)
        if (!is_invalid(m->header, frame)) m->frames[m->valid++] = frame;
    if (m->valid == 0)
        return hs_fail(m->err, HS_ERR_INPUT, "%s: ImageStatus is INVALID for every volume", m->path);
    m->low = m->options.window_low;
    m->high = m->options.window_high;
    if (takes_bytes(m)) return true;
    if (!m->options.has_window && !find_range(m)) return false;
    if (!isfinite(scale_of(m->low, m->high)))
        return hs_fail(m->err, HS_ERR_INPUT, "%s: %g .. %g is too narrow a range to map to 8 bit", m->path,
                       m->low, m->high);
    return make_table(m);
}

hs_metaimage *hs_metaimage_open(const char *path, const hs_metaimage_options *opt, hs_error *err) {
    const hs_metaimage_options defaults = {0};
    if (!opt) opt = &defaults;
    if (!check_window(path, opt, err)) return NULL;
    hs_metaimage *m = calloc(1, sizeof *m);
    if (!m) {
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory to read the file", path);
        return NULL;
    }
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
    *low = file->low;
    *high = file->high;
    return !takes_bytes(file);
}

const hs_frame_fields *hs_metaimage_fields(const hs_metaimage *file, uint32_t index) {
    return file->header->fields ? &file->header->fields[file->frames[index]] : NULL;
}

/* The voxels of volume `index`, and behind those of the last one that the data ends. */
static bool fill(hs_metaimage *m, uint32_t index, hs_volume *out) {
    reading r = {.file = m, .first = (uint64_t)m->frames[index] * hs_volume_count(out)};
    const uint32_t threads = hs_met_voxels_threads(m->voxels);
    const bool ok = m->options.padding == HS_PADDING_AUTO
                        ? hs_volume_fill_marked(out, threads, read_piece, &r, m->err)
                        : hs_volume_fill(out, threads, read_piece, &r, m->err);
    return ok && (index + 1 < m->valid || reach_end(m));
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
    hs_met_voxels_report_to(file->voxels, err);
    return read_volume(file, index, volume);
}

bool hs_metaimage_next(hs_metaimage *m, hs_volume *out, hs_frame_fields *fields) {
    memset(out, 0, sizeof *out);
    const uint32_t index = m->next++;
    const hs_frame_fields *said = hs_metaimage_fields(m, index);
    if (fields) *fields = said ? *said : (hs_frame_fields){0};
    return read_volume(m, index, out);
}

void hs_metaimage_close(hs_metaimage *file) {
    if (!file) return;
    hs_met_voxels_close(file->voxels);
    free(file->frames);
    free(file->table);
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
    ok = ok && hs_metaimage_next(m, out, NULL);
    hs_metaimage_close(m);
    return ok;
}
