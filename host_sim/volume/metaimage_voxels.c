/* SPDX-License-Identifier: MIT */
/* The voxels of a MetaImage file: its bytes as one stream, compressed or not, and the numbers they are. */
#include "core/input_file.h"
#include "core/threads.h"
#include "volume/metaimage_parts.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

struct hs_met_voxels {
    const char *path; /* the header's file */
    hs_met_header header;
    bool gaps; /* NaN and -inf are taken */
    FILE *file;
    uint64_t first; /* where the data starts in the file */
    uint64_t bytes; /* bytes of the data in the file */
    uint64_t left;  /* compressed: of those, not yet read */
    uint64_t voxel_bytes;
    uint64_t delivered; /* compressed: the voxel bytes that have come since the first one */
    z_stream zlib;
    bool zlib_ready, zlib_ended;
    bool lost; /* compressed: a failure left the stream somewhere; only a new start helps */
    uint8_t input[1 << 16];
    uint8_t passed[1 << 15]; /* what is inflated to get past it */
};

/* "<header file>:<line>: ElementDataFile '<name>': " starts every message about the data. */
#define DATA_CONTEXT "%s:%u: ElementDataFile '%s': "
#define DATA_ARGS(d) (d)->path, (d)->header.data_line, (d)->header.data_name

/* The data must fill the file exactly: more or less means that DimSize or ElementType is not what was
 * written. */
static bool check_plain_size(hs_met_voxels *d, uint64_t file_bytes, hs_error *err) {
    const hs_met_header *h = &d->header;
    const uint64_t rest = file_bytes > h->header_size ? file_bytes - h->header_size : 0;
    if (h->header_from_end && file_bytes >= d->voxel_bytes && file_bytes - d->voxel_bytes >= h->header_size) {
        d->first = file_bytes - d->voxel_bytes;
    } else if (!h->header_from_end && rest == d->voxel_bytes) {
        d->first = h->header_size;
    } else {
        return hs_fail(err, HS_ERR_INPUT,
                       DATA_CONTEXT "%" PRIu64 " bytes of data, expected %" PRIu64 " (DimSize %s of %s)",
                       DATA_ARGS(d), rest, d->voxel_bytes, h->size_text, h->type_name);
    }
    d->bytes = d->voxel_bytes;
    return true;
}

static bool check_compressed_size(hs_met_voxels *d, uint64_t file_bytes, hs_error *err) {
    const hs_met_header *h = &d->header;
    d->first = h->header_size;
    d->bytes = file_bytes > h->header_size ? file_bytes - h->header_size : 0;
    if (h->has_compressed_size && h->compressed_size != d->bytes)
        return hs_fail(err, HS_ERR_INPUT,
                       "%s:%u: CompressedDataSize is '%" PRIu64 "', but '%s' has %" PRIu64 " bytes of data",
                       d->path, h->compressed_size_line, h->compressed_size, h->data_name, d->bytes);
    /* Deflate shrinks to 1/1032 at best (zlib technical details, "Maximum Compression Factor"): a size that
     * needs more is not believed, before memory is spent on it. */
    if (d->voxel_bytes / 1032 > d->bytes)
        return hs_fail(err, HS_ERR_INPUT,
                       DATA_CONTEXT "%" PRIu64 " compressed bytes cannot hold DimSize %s of %s", DATA_ARGS(d),
                       d->bytes, h->size_text, h->type_name);
    return true;
}

/* Opens the data file and checks its size against the header, before any voxel is allocated. */
static bool open_data(hs_met_voxels *d, const char *folder, hs_error *err) {
    const hs_met_header *h = &d->header;
    /* At most 2^31 voxels of 4 channels of 8 bytes in 10^5 volumes: no overflow. */
    d->voxel_bytes =
        (uint64_t)h->size[0] * h->size[1] * h->size[2] * h->element_bytes * h->channels * h->frames;
    char context[1024];
    (void)snprintf(context, sizeof context, "%s:%u: ElementDataFile '%s'", DATA_ARGS(d));
    uint64_t file_bytes = 0;
    const hs_input_bounds bounds = {.header = h->local ? NULL : d->path, .folder = folder};
    d->file = hs_input_open_within(bounds, h->data_path, context, &file_bytes, err);
    if (!d->file || !(h->compressed ? check_compressed_size : check_plain_size)(d, file_bytes, err))
        return false;
    d->left = d->bytes;
    /* 15 + 32: the largest window, and a zlib or a gzip header, as MetaIO accepts both. */
    d->zlib_ready = h->compressed && inflateInit2(&d->zlib, 15 + 32) == Z_OK;
    return d->zlib_ready || !h->compressed || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for zlib", d->path);
}

/* From byte `offset` of data that is not compressed, on any number of threads. */
static bool read_plain(const hs_met_voxels *d, uint64_t offset, void *out, size_t bytes, hs_error *err) {
    uint64_t at = d->first + offset;
    const char *reason = hs_input_read_at(d->file, &at, out, bytes);
    return !reason || hs_fail(err, HS_ERR_INPUT, DATA_CONTEXT "cannot be read: %s", DATA_ARGS(d), reason);
}

/* Inflates up to *bytes bytes; *bytes becomes what was made. 0 at the end of the stream or of the file
 * only. */
static bool inflate_some(hs_met_voxels *d, void *out, size_t *bytes, hs_error *err) {
    const size_t room = *bytes < (1u << 30) ? *bytes : 1u << 30; /* zlib counts in 32 bit */
    d->zlib.next_out = out;
    d->zlib.avail_out = (uInt)room;
    while (d->zlib.avail_out == room && !d->zlib_ended) {
        if (d->zlib.avail_in == 0 && d->left > 0) {
            const size_t n = d->left < sizeof d->input ? (size_t)d->left : sizeof d->input;
            if (!read_plain(d, d->bytes - d->left, d->input, n, err)) return false;
            d->left -= n;
            d->zlib.next_in = d->input;
            d->zlib.avail_in = (uInt)n;
        }
        const int code = inflate(&d->zlib, Z_NO_FLUSH);
        d->zlib_ended = code == Z_STREAM_END;
        if (code == Z_BUF_ERROR && d->left == 0) break; /* the input ends before the stream does */
        if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
            return hs_fail(err, code == Z_MEM_ERROR ? HS_ERR_MEMORY : HS_ERR_INPUT,
                           DATA_CONTEXT "CompressedData is damaged about byte %" PRIu64 ": %s", DATA_ARGS(d),
                           d->bytes - d->left - d->zlib.avail_in, d->zlib.msg ? d->zlib.msg : zError(code));
    }
    *bytes = room - d->zlib.avail_out;
    return true;
}

static bool inflate_all(hs_met_voxels *d, void *out, size_t bytes, hs_error *err) {
    d->lost = true; /* until all is there */
    for (uint8_t *at = out; bytes > 0;) {
        size_t got = bytes;
        if (!inflate_some(d, at, &got, err)) return false;
        if (got == 0)
            return hs_fail(err, HS_ERR_INPUT,
                           DATA_CONTEXT "CompressedData %s after %" PRIu64 " voxel bytes, expected %" PRIu64,
                           DATA_ARGS(d), d->zlib_ended ? "ends" : "is cut off", d->delivered, d->voxel_bytes);
        d->delivered += got;
        at += got;
        bytes -= got;
    }
    d->lost = false;
    return true;
}

static void start_anew(hs_met_voxels *d) {
    (void)inflateReset(&d->zlib); /* fails on a stream that was never made only */
    d->zlib.avail_in = 0;
    d->zlib_ended = false;
    d->delivered = 0;
    d->lost = false;
    d->left = d->bytes;
}

/* To byte `offset` of compressed voxels: forward costs the inflating of what is passed over, backward that of
 * all from the first byte on. */
static bool seek(hs_met_voxels *d, uint64_t offset, hs_error *err) {
    if (d->lost || offset < d->delivered) start_anew(d);
    while (d->delivered < offset) {
        const uint64_t left = offset - d->delivered;
        const size_t n = left < sizeof d->passed ? (size_t)left : sizeof d->passed;
        if (!inflate_all(d, d->passed, n, err)) return false;
    }
    return true;
}

bool hs_met_voxels_finish(hs_met_voxels *d, hs_error *err) {
    if (!d->header.compressed) return true; /* its size was checked when it was opened */
    if (!seek(d, d->voxel_bytes, err)) return false;
    uint8_t extra;
    size_t got = 1;
    d->lost = true; /* a byte may have gone by */
    if (!inflate_some(d, &extra, &got, err)) return false;
    if (got > 0)
        return hs_fail(err, HS_ERR_INPUT,
                       DATA_CONTEXT "CompressedData holds more than the %" PRIu64 " voxel bytes expected",
                       DATA_ARGS(d), d->voxel_bytes);
    if (!d->zlib_ended)
        return hs_fail(err, HS_ERR_INPUT, DATA_CONTEXT "CompressedData is cut off in its checksum",
                       DATA_ARGS(d));
    const uint64_t trailing = d->left + d->zlib.avail_in;
    if (trailing > 0)
        return hs_fail(err, HS_ERR_INPUT, DATA_CONTEXT "%" PRIu64 " bytes follow after the compressed data",
                       DATA_ARGS(d), trailing);
    return true;
}

static void swap_bytes(uint8_t *bytes, size_t count, size_t width) {
    for (uint8_t *end = bytes + count * width; bytes < end; bytes += width)
        for (size_t k = 0; k < width / 2; k++) {
            const uint8_t low = bytes[k];
            bytes[k] = bytes[width - 1 - k];
            bytes[width - 1 - k] = low;
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

hs_met_voxels *hs_met_voxels_open(const char *path, const char *folder, hs_error *err) {
    hs_met_voxels *v = hs_memory(1, sizeof *v, path, err);
    if (!v) return NULL;
    v->path = path;
    if (hs_met_header_read(path, folder, &v->header, err) && open_data(v, folder, err)) return v;
    hs_met_voxels_close(v);
    return NULL;
}

void hs_met_voxels_close(hs_met_voxels *v) {
    if (!v) return;
    if (v->zlib_ready) (void)inflateEnd(&v->zlib);
    if (v->file) (void)fclose(v->file);
    free(v->header.fields);
    free(v);
}

void hs_met_voxels_allow_gaps(hs_met_voxels *v) {
    v->gaps = true;
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
    if (!v->header.compressed) return read_plain(v, at, out, bytes, err);
    return seek(v, at, err) && inflate_all(v, out, bytes, err);
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
