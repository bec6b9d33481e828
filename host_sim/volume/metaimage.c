/* SPDX-License-Identifier: MIT */
#include "volume/metaimage.h"

#include "volume/metaimage_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK_VOXELS = 32768 };

/* Room for one chunk: bytes as they stand in the file, and their values. */
typedef struct {
    uint8_t raw[CHUNK_VOXELS * 8];
    double value[CHUNK_VOXELS];
} chunk;

/* The volume being read. */
typedef struct {
    const char *path;
    const hs_met_header *header;
    hs_met_data *data;
    chunk *chunk;
    hs_volume *volume;
    hs_error *err;
} reader;

static void swap_bytes(uint8_t *bytes, size_t count, size_t width) {
    for (size_t i = 0; i < count; i++) {
        for (size_t low = 0, high = width - 1; low < high; low++, high--) {
            const uint8_t kept = bytes[i * width + low];
            bytes[i * width + low] = bytes[i * width + high];
            bytes[i * width + high] = kept;
        }
    }
}

/* memcpy, since the bytes need not be aligned for the type. */
#define DECODE(type)                                                                                         \
    for (size_t i = 0; i < count; i++) {                                                                     \
        type v;                                                                                              \
        memcpy(&v, raw + i * sizeof v, sizeof v);                                                            \
        value[i] = (double)v;                                                                                \
    }                                                                                                        \
    break

static void decode(hs_met_type type, const uint8_t *raw, size_t count, double *value) {
    switch (type) {
    case HS_MET_CHAR:
        DECODE(int8_t);
    case HS_MET_UCHAR:
        DECODE(uint8_t);
    case HS_MET_SHORT:
        DECODE(int16_t);
    case HS_MET_USHORT:
        DECODE(uint16_t);
    case HS_MET_INT:
        DECODE(int32_t);
    case HS_MET_UINT:
        DECODE(uint32_t);
    case HS_MET_LONG_LONG:
        DECODE(int64_t);
    case HS_MET_ULONG_LONG:
        DECODE(uint64_t);
    case HS_MET_FLOAT:
        DECODE(float);
    case HS_MET_DOUBLE:
        DECODE(double);
    }
}

/* Reads voxels first .. first + count - 1, which must be the next ones, into
 * chunk->value; all of them finite. */
static bool read_chunk(reader *r, size_t first, size_t count) {
    const hs_met_header *h = r->header;
    if (!hs_met_data_read(r->data, r->chunk->raw, count * h->element_bytes, r->err)) return false;
    const bool host_is_big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    if (h->big_endian != host_is_big) swap_bytes(r->chunk->raw, count, h->element_bytes);
    decode(h->type, r->chunk->raw, count, r->chunk->value);
    if (h->type != HS_MET_FLOAT && h->type != HS_MET_DOUBLE) return true;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(r->chunk->value[i])) continue;
        const size_t at = first + i, nx = h->size[0], ny = h->size[1];
        return hs_fail(r->err, HS_ERR_INPUT,
                       "%s:%u: ElementDataFile '%s': voxel (%zu, %zu, %zu) is '%g', expected a finite number",
                       r->path, h->data_line, h->data_name, at % nx, at / nx % ny, at / nx / ny,
                       r->chunk->value[i]);
    }
    return true;
}

/* Reads the data once for its smallest and largest value. */
static bool find_range(reader *r, size_t count, double *low, double *high) {
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t first = 0; first < count; first += CHUNK_VOXELS) {
        const size_t n = count - first < CHUNK_VOXELS ? count - first : CHUNK_VOXELS;
        if (!read_chunk(r, first, n)) return false;
        for (size_t i = 0; i < n; i++) {
            const double v = r->chunk->value[i];
            *low = v < *low ? v : *low;
            *high = v > *high ? v : *high;
        }
    }
    if (!hs_met_data_finish(r->data, r->err)) return false;
    if (!(*low < *high))
        return hs_fail(
            r->err, HS_ERR_INPUT,
            "%s:%u: ElementDataFile '%s': every voxel is %g: no range to map to 8 bit, give a window",
            r->path, r->header->data_line, r->header->data_name, *low);
    return hs_met_data_rewind(r->data, r->err);
}

/* Reads the data and maps low .. high to 0 .. 255, rounding to the nearest level. */
static bool read_mapped(reader *r, size_t count, double low, double high) {
    /* Halved, since high - low may exceed the largest double. */
    const double scale = 255.0 / (high * 0.5 - low * 0.5);
    if (!isfinite(scale))
        return hs_fail(r->err, HS_ERR_INPUT, "%s: %g .. %g is too narrow a range to map to 8 bit", r->path,
                       low, high);
    for (size_t first = 0; first < count; first += CHUNK_VOXELS) {
        const size_t n = count - first < CHUNK_VOXELS ? count - first : CHUNK_VOXELS;
        if (!read_chunk(r, first, n)) return false;
        for (size_t i = 0; i < n; i++) {
            const double level = (r->chunk->value[i] * 0.5 - low * 0.5) * scale;
            const double clamped = level < 0.0 ? 0.0 : level > 255.0 ? 255.0 : level;
            r->volume->voxels[first + i] = (uint8_t)(clamped + 0.5);
        }
    }
    return true;
}

static bool read_voxels(reader *r, const hs_metaimage_options *opt) {
    const size_t count = hs_volume_count(r->volume);
    double low = opt->window_low, high = opt->window_high;
    bool ok;
    if (r->header->type == HS_MET_UCHAR && !opt->has_window)
        ok = hs_met_data_read(r->data, r->volume->voxels, count, r->err);
    else
        ok = (opt->has_window || find_range(r, count, &low, &high)) && read_mapped(r, count, low, high);
    return ok && hs_met_data_finish(r->data, r->err);
}

static bool apply_padding(hs_volume *volume, hs_padding padding, hs_error *err) {
    if (padding == HS_PADDING_AUTO) return hs_volume_mark_unscanned(volume, err);
    if (padding == HS_PADDING_NONE) hs_volume_mark_all_scanned(volume);
    return true;
}

/* Allocates the volume the header describes, named after the file. */
static bool make_volume(const reader *r, const hs_metaimage_options *opt) {
    const hs_met_header *h = r->header;
    hs_error cause = {0};
    if (!hs_volume_init(r->volume, h->size[0], h->size[1], h->size[2], &cause))
        return hs_fail(r->err, cause.code, "%s:%u: DimSize: %s", r->path, h->dim_line, cause.text);
    memcpy(r->volume->spacing, h->spacing, sizeof h->spacing);
    r->volume->pose = h->pose;
    r->volume->probe = opt->has_probe ? opt->probe : h->probe;
    const char *slash = strrchr(r->path, '/');
    (void)snprintf(r->volume->name, sizeof r->volume->name, "%s", slash ? slash + 1 : r->path);
    return true;
}

/* Room, header and stream of r->path; reader_close frees them, whatever came of it. */
static bool reader_open(reader *r) {
    hs_met_header *header = malloc(sizeof *header);
    r->header = header;
    r->chunk = malloc(sizeof *r->chunk);
    if (!header || !r->chunk)
        return hs_fail(r->err, HS_ERR_MEMORY, "%s: no memory to read the file", r->path);
    if (!hs_met_header_read(r->path, header, r->err)) return false;
    r->data = hs_met_data_open(r->path, header, r->err);
    return r->data != NULL;
}

static void reader_close(reader *r) {
    hs_met_data_close(r->data);
    free(r->chunk);
    free((void *)r->header);
}

bool hs_metaimage_read(const char *path, const hs_metaimage_options *opt, hs_volume *out, hs_error *err) {
    memset(out, 0, sizeof *out);
    const hs_metaimage_options defaults = {0};
    if (!opt) opt = &defaults;
    const bool is_window =
        isfinite(opt->window_low) && isfinite(opt->window_high) && opt->window_low < opt->window_high;
    if (opt->has_window && !is_window)
        return hs_fail(err, HS_ERR_USAGE, "%s: window is %g .. %g, expected two finite numbers, low < high",
                       path, opt->window_low, opt->window_high);
    reader r = {.path = path, .volume = out, .err = err};
    const bool ok = reader_open(&r) && make_volume(&r, opt) && read_voxels(&r, opt) &&
                    apply_padding(out, opt->padding, err);
    if (!ok) hs_volume_free(out);
    reader_close(&r);
    return ok;
}

bool hs_metaimage_read_map(const char *path, uint32_t nx, uint32_t ny, double *values, hs_error *err) {
    reader r = {.path = path, .err = err};
    bool ok = reader_open(&r);
    const hs_met_header *h = r.header;
    if (ok && (h->size[0] != nx || h->size[1] != ny || h->size[2] != 1))
        ok = hs_fail(err, HS_ERR_INPUT, "%s:%u: DimSize is %u x %u x %u, expected %u x %u x 1", path,
                     h->dim_line, h->size[0], h->size[1], h->size[2], nx, ny);
    const size_t count = (size_t)nx * ny;
    for (size_t first = 0; ok && first < count; first += CHUNK_VOXELS) {
        const size_t n = count - first < CHUNK_VOXELS ? count - first : CHUNK_VOXELS;
        ok = read_chunk(&r, first, n);
        if (ok) memcpy(values + first, r.chunk->value, n * sizeof *values);
    }
    ok = ok && hs_met_data_finish(r.data, err);
    reader_close(&r);
    return ok;
}
