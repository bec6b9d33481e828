/* SPDX-License-Identifier: MIT */
/* The voxel bytes of a MetaImage file as one stream, compressed or not. */
#include "base/input_file.h"
#include "volume/metaimage_parts.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

struct hs_met_data {
    const char *path; /* the header's file */
    const hs_met_header *header;
    FILE *file;
    uint64_t first; /* where the data starts in the file */
    uint64_t bytes; /* bytes of the data in the file */
    uint64_t left;  /* of those, not yet read */
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
#define DATA_ARGS(d) (d)->path, (d)->header->data_line, (d)->header->data_name

/* The data must fill the file exactly: more or less means that DimSize or ElementType is not what was
 * written. */
static bool check_plain_size(hs_met_data *d, uint64_t file_bytes, hs_error *err) {
    const hs_met_header *h = d->header;
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

static bool check_compressed_size(hs_met_data *d, uint64_t file_bytes, hs_error *err) {
    const hs_met_header *h = d->header;
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

hs_met_data *hs_met_data_open(const char *path, const hs_met_header *header, hs_error *err) {
    hs_met_data *d = hs_memory(1, sizeof *d, path, err);
    if (!d) return NULL;
    d->path = path;
    d->header = header;
    /* At most 2^31 voxels of 4 channels of 8 bytes in 10^5 volumes: no overflow. */
    d->voxel_bytes = (uint64_t)header->size[0] * header->size[1] * header->size[2] * header->element_bytes *
                     header->channels * header->frames;
    char context[1024];
    (void)snprintf(context, sizeof context, "%s:%u: ElementDataFile '%s'", DATA_ARGS(d));
    uint64_t file_bytes = 0;
    d->file = hs_input_open_below(header->local ? NULL : path, header->data_path, context, &file_bytes, err);
    bool ok = d->file != NULL;
    ok = ok && (header->compressed ? check_compressed_size(d, file_bytes, err)
                                   : check_plain_size(d, file_bytes, err));
    if (ok && header->compressed) {
        /* 15 + 32: the largest window, and a zlib or a gzip header, as MetaIO accepts both. */
        d->zlib_ready = inflateInit2(&d->zlib, 15 + 32) == Z_OK;
        if (!d->zlib_ready) ok = hs_fail(err, HS_ERR_MEMORY, "%s: no memory for zlib", path);
    }
    d->left = d->bytes;
    if (ok) return d;
    hs_met_data_close(d);
    return NULL;
}

bool hs_met_data_read_at(const hs_met_data *d, uint64_t offset, void *out, size_t bytes, hs_error *err) {
    uint64_t at = d->first + offset;
    const char *reason = hs_input_read_at(d->file, &at, out, bytes);
    return !reason || hs_fail(err, HS_ERR_INPUT, DATA_CONTEXT "cannot be read: %s", DATA_ARGS(d), reason);
}

/* The next bytes in the file. */
static bool read_file(hs_met_data *d, void *out, size_t bytes, hs_error *err) {
    if (!hs_met_data_read_at(d, d->bytes - d->left, out, bytes, err)) return false;
    d->left -= bytes;
    return true;
}

/* Inflates up to *bytes bytes; *bytes becomes what was made. 0 at the end of the stream or of the file
 * only. */
static bool inflate_some(hs_met_data *d, void *out, size_t *bytes, hs_error *err) {
    const size_t room = *bytes < (1u << 30) ? *bytes : 1u << 30; /* zlib counts in 32 bit */
    d->zlib.next_out = out;
    d->zlib.avail_out = (uInt)room;
    while (d->zlib.avail_out == room && !d->zlib_ended) {
        if (d->zlib.avail_in == 0 && d->left > 0) {
            const size_t n = d->left < sizeof d->input ? (size_t)d->left : sizeof d->input;
            if (!read_file(d, d->input, n, err)) return false;
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

static bool inflate_all(hs_met_data *d, void *out, size_t bytes, hs_error *err) {
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

bool hs_met_data_read(hs_met_data *d, void *out, size_t bytes, hs_error *err) {
    return d->header->compressed ? inflate_all(d, out, bytes, err) : read_file(d, out, bytes, err);
}

static void start_anew(hs_met_data *d) {
    (void)inflateReset(&d->zlib); /* fails on a stream that was never made only */
    d->zlib.avail_in = 0;
    d->zlib_ended = false;
    d->delivered = 0;
    d->lost = false;
    d->left = d->bytes;
}

bool hs_met_data_seek(hs_met_data *d, uint64_t offset, hs_error *err) {
    if (!d->header->compressed) {
        d->left = d->bytes - offset;
        return true;
    }
    if (d->lost || offset < d->delivered) start_anew(d);
    while (d->delivered < offset) {
        const uint64_t left = offset - d->delivered;
        const size_t n = left < sizeof d->passed ? (size_t)left : sizeof d->passed;
        if (!inflate_all(d, d->passed, n, err)) return false;
    }
    return true;
}

bool hs_met_data_finish(hs_met_data *d, hs_error *err) {
    if (!d->header->compressed) return true; /* its size was checked when it was opened */
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

void hs_met_data_close(hs_met_data *d) {
    if (!d) return;
    if (d->zlib_ready) (void)inflateEnd(&d->zlib);
    if (d->file) (void)fclose(d->file);
    free(d);
}
