/* SPDX-License-Identifier: MIT */
#include "commands/info_timing.h"

#include "base/progress.h"
#include "commands/info_sampling.h"
#include "volume/metaimage_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

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

static bool read_bytes(const target *t, hs_error *err) {
    size_t bytes = t->bytes;
    uint8_t *memory = hs_plain_bytes(t->data_path, 0, &bytes, err);
    free(memory);
    return memory != NULL;
}

static bool inflate_bytes(const target *t, hs_error *err) {
    return hs_plain_inflate(t->data_path, t->first, t->bytes, err);
}

/* The samples of a Kretz file, its header checked, without their Cartesian copy. */
static bool read_samples(const target *t, hs_error *err) {
    hs_kretz *kretz = hs_kretz_open(t->path, t->kretz, err);
    uint8_t *memory = kretz ? malloc(t->bytes) : NULL;
    const bool ok =
        kretz && (memory ? hs_kretz_read_bytes(kretz, 0, memory, err)
                         : hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", t->path, t->bytes));
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
