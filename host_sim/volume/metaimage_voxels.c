/* SPDX-License-Identifier: MIT */
#include "base/threads.h"
#include "volume/metaimage_parts.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct hs_met_voxels {
    const char *path;
    hs_error *err;
    hs_met_header header;
    hs_met_data *data;
    size_t at; /* the next voxel, counted from the file's first */
    bool gaps; /* NaN and -inf are taken */
    hs_met_room room;
};

/* memcpy, since the bytes need not be aligned for the type. */
#define SWAP(type, swapped)                                                                                  \
    for (size_t i = 0; i < count; i++) {                                                                     \
        type v;                                                                                              \
        memcpy(&v, bytes + i * sizeof v, sizeof v);                                                          \
        v = swapped(v);                                                                                      \
        memcpy(bytes + i * sizeof v, &v, sizeof v);                                                          \
    }                                                                                                        \
    break

static void swap_bytes(uint8_t *bytes, size_t count, size_t width) {
    switch (width) {
    case 2:
        SWAP(uint16_t, __builtin_bswap16);
    case 4:
        SWAP(uint32_t, __builtin_bswap32);
    case 8:
        SWAP(uint64_t, __builtin_bswap64);
    default:
        break;
    }
}

/* Sixteen at a time, which compilers turn into vectors. */
#define DECODE(type)                                                                                         \
    {                                                                                                        \
        type v[16];                                                                                          \
        size_t i = 0;                                                                                        \
        for (; i + 16 <= count; i += 16) {                                                                   \
            memcpy(v, raw + i * sizeof *v, sizeof v);                                                        \
            for (size_t k = 0; k < 16; k++) value[i + k] = (double)v[k];                                     \
        }                                                                                                    \
        for (; i < count; i++) {                                                                             \
            memcpy(v, raw + i * sizeof *v, sizeof *v);                                                       \
            value[i] = (double)v[0];                                                                         \
        }                                                                                                    \
    }                                                                                                        \
    break

void hs_met_decode(hs_met_type type, const uint8_t *raw, size_t count, double *value) {
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
    case HS_MET_TYPES:
        break;
    }
}

hs_met_voxels *hs_met_voxels_open(const char *path, hs_error *err) {
    hs_met_voxels *v = hs_memory(1, sizeof *v, path, err);
    if (!v) return NULL;
    v->path = path;
    v->err = err;
    if (hs_met_header_read(path, &v->header, err)) v->data = hs_met_data_open(path, &v->header, err);
    if (v->data) return v;
    hs_met_voxels_close(v);
    return NULL;
}

void hs_met_voxels_close(hs_met_voxels *v) {
    if (!v) return;
    hs_met_data_close(v->data);
    hs_met_header_free(&v->header);
    free(v);
}

void hs_met_voxels_allow_gaps(hs_met_voxels *v) {
    v->gaps = true;
}

void hs_met_voxels_report_to(hs_met_voxels *v, hs_error *err) {
    v->err = err;
}

const hs_met_header *hs_met_voxels_header(const hs_met_voxels *v) {
    return &v->header;
}

/* +inf is a fault in any case. */
static bool are_taken(const double *value, size_t count, bool gaps) {
    int bad = 0;
    size_t i = 0;
    for (; i + 16 <= count; i += 16)
        for (size_t k = 0; k < 16; k++)
            bad |= (value[i + k] > DBL_MAX) | (!gaps & !(value[i + k] >= -DBL_MAX));
    for (; i < count; i++) bad |= !(isfinite(value[i]) || (gaps && !(value[i] > 0.0)));
    return !bad;
}

/* Names the first of `count` voxels from `at` on that is no number. */
static bool all_taken(const hs_met_voxels *v, uint64_t at, size_t count, const double *value, hs_error *err) {
    if (are_taken(value, count, v->gaps)) return true;
    const hs_met_header *h = &v->header;
    const uint64_t nx = h->size[0], ny = h->size[1], volume = nx * ny * h->size[2];
    size_t i = 0;
    while (are_taken(value + i, 1, v->gaps)) i++;
    const uint64_t in = (at + i) % volume;
    char which[40] = "";
    if (h->frames > 1) (void)snprintf(which, sizeof which, " of volume %" PRIu64, (at + i) / volume);
    return hs_fail(err, HS_ERR_INPUT,
                   "%s:%u: ElementDataFile '%s': voxel (%" PRIu64 ", %" PRIu64 ", %" PRIu64
                   ")%s is '%g', expected a finite number",
                   v->path, h->data_line, h->data_name, in % nx, in / nx % ny, in / nx / ny, which, value[i]);
}

static bool file_bytes_at(hs_met_voxels *v, uint64_t at, size_t bytes, uint8_t *out, hs_error *err) {
    if (!v->header.compressed) return hs_met_data_read_at(v->data, at, out, bytes, err);
    return hs_met_data_seek(v->data, at, err) && hs_met_data_read(v->data, out, bytes, err);
}

/* The first of the channels; of grey the second and third are the same. */
static bool first_channel(const hs_met_voxels *v, const uint8_t *from, size_t count, uint8_t *out,
                          hs_error *err) {
    const hs_met_header *h = &v->header;
    const size_t width = h->element_bytes;
    for (size_t i = 0; i < count; i++, from += h->channels * width, out += width) {
        if (memcmp(from, from + width, width) != 0 || memcmp(from, from + 2 * width, width) != 0)
            return hs_fail(err, HS_ERR_INPUT,
                           "%s: is in colour: its %u channels differ. Convert it to grey first, in 3D Slicer "
                           "with Vector to Scalar Volume",
                           v->path, h->channels);
        memcpy(out, from, width);
    }
    return true;
}

bool hs_met_voxels_bytes_at(hs_met_voxels *v, uint64_t at, size_t bytes, uint8_t *out, hs_error *err) {
    const hs_met_header *h = &v->header;
    uint8_t piece[4 * 8 * 512];
    if (h->channels == 1) return file_bytes_at(v, at, bytes, out, err);
    for (size_t done = 0, n; done < bytes; done += n) {
        n = sizeof piece / h->channels / h->element_bytes * h->element_bytes;
        if (n > bytes - done) n = bytes - done;
        if (!file_bytes_at(v, (at + done) * h->channels, n * h->channels, piece, err) ||
            !first_channel(v, piece, n / h->element_bytes, out + done, err))
            return false;
    }
    return true;
}

bool hs_met_voxels_raw_at(hs_met_voxels *v, uint64_t at, size_t count, hs_met_room *room, hs_error *err) {
    const hs_met_header *h = &v->header;
    if (!hs_met_voxels_bytes_at(v, at * h->element_bytes, count * h->element_bytes, room->raw, err))
        return false;
    const bool host_is_big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
    if (h->big_endian != host_is_big) swap_bytes(room->raw, count, h->element_bytes);
    return true;
}

bool hs_met_voxels_read_at(hs_met_voxels *v, uint64_t at, size_t count, hs_met_room *room, hs_error *err) {
    const hs_met_header *h = &v->header;
    if (!hs_met_voxels_raw_at(v, at, count, room, err)) return false;
    hs_met_decode(h->type, room->raw, count, room->value);
    return (h->type != HS_MET_FLOAT && h->type != HS_MET_DOUBLE) || all_taken(v, at, count, room->value, err);
}

uint32_t hs_met_voxels_threads(const hs_met_voxels *v) {
    return v->header.compressed ? 1 : hs_thread_count(0);
}

const double *hs_met_voxels_read(hs_met_voxels *v, size_t count, const uint8_t **raw) {
    if (!hs_met_voxels_read_at(v, v->at, count, &v->room, v->err)) return NULL;
    v->at += count;
    if (raw) *raw = v->room.raw;
    return v->room.value;
}

bool hs_met_voxels_skip(hs_met_voxels *v, size_t count) {
    return hs_met_voxels_seek(v, v->at + count);
}

bool hs_met_voxels_seek(hs_met_voxels *v, uint64_t at) {
    v->at = (size_t)at;
    return hs_met_data_seek(v->data, at * v->header.element_bytes * v->header.channels, v->err);
}

bool hs_met_voxels_finish(hs_met_voxels *v) {
    return hs_met_data_finish(v->data, v->err);
}
