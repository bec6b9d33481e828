/* SPDX-License-Identifier: MIT */
#include "commands/info_timing.h"

#include "base/progress.h"
#include "commands/info_sampling.h"
#include "volume/metaimage_header.h"
#include "volume/metaimage_open.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

#define TURNS 5

/* A file's first volume. */
typedef struct {
    const char *path;
    const hs_kretz_options *kretz; /* options; of a MetaImage file not looked at */
    const char *data_path;         /* the file that holds the voxels */
    uint64_t first;                /* where compressed ones start there */
    size_t bytes;                  /* of the voxels there; of compressed ones, how many they become */
} target;

/* What is timed: false with an error. */
typedef bool (*reader)(const target *t, hs_error *err);

static uint8_t *make_room(const target *t, size_t bytes, hs_error *err) {
    uint8_t *memory = malloc(bytes ? bytes : 1);
    if (!memory) (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", t->path, bytes);
    return memory;
}

/* The file's bytes from `first` on, up to *bytes of them, as fast as the system gives them; the caller frees.
 */
static uint8_t *take_bytes(const target *t, uint64_t first, size_t *bytes, hs_error *err) {
    uint64_t size = 0;
    FILE *file = hs_met_open(t->data_path, t->path, &size, err);
    if (!file) return NULL;
    if (size - first < *bytes) *bytes = (size_t)(size - first);
    uint8_t *memory = make_room(t, *bytes, err);
    bool ok = memory != NULL;
    for (size_t at = 0; ok && at < *bytes;) {
        const ssize_t got = pread(fileno(file), memory + at, *bytes - at, (off_t)(first + at));
        ok = got > 0 || hs_fail(err, HS_ERR_INPUT, "%s: cannot be read", t->path);
        at += ok ? (size_t)got : 0;
    }
    (void)fclose(file);
    if (ok) return memory;
    free(memory);
    return NULL;
}

static bool read_bytes(const target *t, hs_error *err) {
    size_t bytes = t->bytes;
    uint8_t *memory = take_bytes(t, 0, &bytes, err);
    free(memory);
    return memory != NULL;
}

/* Compressed bytes in one piece, and what zlib makes of them in another. */
static bool inflate_bytes(const target *t, hs_error *err) {
    size_t packed = SIZE_MAX;
    uint8_t *in = take_bytes(t, t->first, &packed, err), *out = in ? make_room(t, t->bytes, err) : NULL;
    z_stream z = {.next_in = in, .next_out = out};
    bool ok = out && (inflateInit2(&z, 15 + 32) == Z_OK || hs_fail(err, HS_ERR_MEMORY, "%s: zlib", t->path));
    const bool started = ok;
    for (int code = Z_OK; ok && code == Z_OK && z.total_out < t->bytes;) {
        const size_t in_left = packed - z.total_in, out_left = t->bytes - z.total_out;
        z.avail_in = (uInt)(in_left < 1u << 30 ? in_left : 1u << 30); /* zlib counts in 32 bit */
        z.avail_out = (uInt)(out_left < 1u << 30 ? out_left : 1u << 30);
        code = inflate(&z, Z_NO_FLUSH);
        ok = code == Z_OK || code == Z_STREAM_END || hs_fail(err, HS_ERR_INPUT, "%s: zlib", t->path);
    }
    if (started) (void)inflateEnd(&z);
    free(in);
    free(out);
    return ok;
}

/* The samples of a Kretz file, its header checked, without their Cartesian copy. */
static bool read_samples(const target *t, hs_error *err) {
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    uint8_t *memory = kretz ? make_room(t, t->bytes, err) : NULL;
    const bool ok = memory && hs_kretz_read_bytes(kretz, 0, memory, err);
    free(memory);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_kretz(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    const bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    hs_volume_free(&volume);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_metaimage(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_metaimage *file = hs_metaimage_open(t->path, NULL, err);
    const bool ok = file && hs_metaimage_read_at(file, 0, &volume, err);
    hs_volume_free(&volume);
    hs_metaimage_close(file);
    return ok;
}

static bool shortest(reader read_it, const target *t, double *ms, hs_error *err) {
    *ms = INFINITY;
    for (int turn = 0; turn < TURNS; turn++) {
        const double start = hs_now();
        if (!read_it(t, err)) return false;
        *ms = fmin(*ms, (hs_now() - start) * 1e3);
    }
    return true;
}

static void print_base(const char *what, double ms, size_t bytes) {
    (void)printf("  reading it, the shortest of %d times:\n    %-26s %9.2f ms (%zu bytes)\n", TURNS, what, ms,
                 bytes);
}

static void print_line(const char *what, double ms, double base_ms) {
    (void)printf("    %-26s %9.2f ms, %.2f times that\n", what, ms, ms / base_ms);
}

/* Only a volume that was scanned by a probe has two grids to sample. */
static bool time_sampling(const target *t, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    hs_kretz_close(kretz);
    ok = ok && (!volume.beams || hs_info_sampling(&volume, err));
    hs_volume_free(&volume);
    return ok;
}

static bool time_kretz(target t, hs_error *err) {
    double bytes_ms, samples_ms, volume_ms;
    hs_kretz *kretz = hs_kretz_open(t.path, t.kretz, err);
    if (!kretz) return false;
    t.bytes = hs_kretz_bytes(kretz);
    hs_kretz_close(kretz);
    if (!shortest(read_samples, &t, &samples_ms, err) || !shortest(read_kretz, &t, &volume_ms, err) ||
        !shortest(read_bytes, &t, &bytes_ms, err))
        return false;
    print_base("its bytes alone", bytes_ms, t.bytes);
    print_line("samples", samples_ms, bytes_ms);
    print_line("with the Cartesian copy", volume_ms, bytes_ms);
    return time_sampling(&t, err);
}

/* zlib decides how long compressed bytes take, so they are compared with zlib alone. */
static bool time_metaimage(target t, hs_error *err) {
    hs_met_header header;
    double base_ms = 0, volume_ms = 0;
    bool ok = hs_met_header_read(t.path, &header, err);
    if (ok) {
        t.data_path = header.data_path;
        t.first = header.header_size;
        t.bytes = (size_t)header.size[0] * header.size[1] * header.size[2] * header.element_bytes;
        ok = shortest(read_metaimage, &t, &volume_ms, err) &&
             shortest(header.compressed ? inflate_bytes : read_bytes, &t, &base_ms, err);
    }
    if (ok) {
        print_base(header.compressed ? "inflating alone" : "its bytes alone", base_ms, t.bytes);
        print_line("volume", volume_ms, base_ms);
    }
    hs_met_header_free(&header);
    return ok;
}

bool hs_info_timing(const char *path, const hs_kretz_options *kretz, hs_error *err) {
    const target t = {.path = path, .kretz = kretz, .data_path = path};
    return hs_kretz_is_file(path) ? time_kretz(t, err) : time_metaimage(t, err);
}
