/* SPDX-License-Identifier: MIT */
#include "volume/plain_bytes.h"

#include "volume/metaimage_open.h"

#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

static uint8_t *make_room(const char *path, size_t bytes, hs_error *err) {
    uint8_t *memory = malloc(bytes ? bytes : 1);
    if (!memory) (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", path, bytes);
    return memory;
}

uint8_t *hs_plain_bytes(const char *path, uint64_t first, size_t *bytes, hs_error *err) {
    uint64_t size = 0;
    FILE *file = hs_met_open(path, path, &size, err);
    if (!file) return NULL;
    const uint64_t there = size > first ? size - first : 0;
    if (there < *bytes) *bytes = (size_t)there;
    uint8_t *memory = make_room(path, *bytes, err);
    bool ok = memory != NULL;
    for (size_t at = 0; ok && at < *bytes;) {
        const ssize_t got = pread(fileno(file), memory + at, *bytes - at, (off_t)(first + at));
        ok = got > 0 || hs_fail(err, HS_ERR_INPUT, "%s: cannot be read", path);
        at += ok ? (size_t)got : 0;
    }
    (void)fclose(file);
    if (ok) return memory;
    free(memory);
    return NULL;
}

static bool inflate_to(z_stream *z, size_t in_bytes, size_t out_bytes) {
    for (int code = Z_OK; code == Z_OK && z->total_out < out_bytes;) {
        const size_t in_left = in_bytes - z->total_in, out_left = out_bytes - z->total_out;
        z->avail_in = (uInt)(in_left < 1u << 30 ? in_left : 1u << 30); /* zlib counts in 32 bit */
        z->avail_out = (uInt)(out_left < 1u << 30 ? out_left : 1u << 30);
        code = inflate(z, Z_NO_FLUSH);
        if (code != Z_OK && code != Z_STREAM_END) return false;
    }
    return z->total_out == out_bytes;
}

bool hs_plain_inflate(const char *path, uint64_t first, size_t bytes, hs_error *err) {
    size_t packed = SIZE_MAX;
    uint8_t *in = hs_plain_bytes(path, first, &packed, err);
    uint8_t *out = in ? make_room(path, bytes, err) : NULL;
    z_stream z = {.next_in = in, .next_out = out};
    bool ok = out && (inflateInit2(&z, 15 + 32) == Z_OK || hs_fail(err, HS_ERR_MEMORY, "%s: zlib", path));
    if (ok) {
        ok = inflate_to(&z, packed, bytes) || hs_fail(err, HS_ERR_INPUT, "%s: cannot be inflated", path);
        (void)inflateEnd(&z);
    }
    free(in);
    free(out);
    return ok;
}
