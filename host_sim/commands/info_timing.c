/* SPDX-License-Identifier: MIT */
#include "commands/info_timing.h"

#include "base/progress.h"
#include "commands/info_sampling.h"
#include "volume/metaimage_open.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define TURNS 5

/* What is timed: false with an error, or the bytes that it took from the file. */
typedef bool (*reader)(const char *path, const hs_kretz_options *kretz, size_t *bytes, hs_error *err);

/* All of a file, up to *bytes of it, as fast as the system gives it. */
static bool read_bytes(const char *path, const hs_kretz_options *kretz, size_t *bytes, hs_error *err) {
    (void)kretz;
    uint64_t size = 0;
    FILE *file = hs_met_open(path, path, &size, err);
    if (!file) return false;
    if (size < *bytes) *bytes = (size_t)size;
    uint8_t *memory = malloc(*bytes);
    bool ok = memory != NULL || hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", path, *bytes);
    for (size_t at = 0; ok && at < *bytes;) {
        const ssize_t got = read(fileno(file), memory + at, *bytes - at);
        ok = got > 0 || hs_fail(err, HS_ERR_INPUT, "%s: cannot be read", path);
        at += ok ? (size_t)got : 0;
    }
    free(memory);
    (void)fclose(file);
    return ok;
}

/* The samples of a Kretz file, its header checked, without their Cartesian copy. */
static bool read_samples(const char *path, const hs_kretz_options *options, size_t *bytes, hs_error *err) {
    hs_kretz *kretz = hs_kretz_open(path, options, err);
    if (!kretz) return false;
    *bytes = hs_kretz_bytes(kretz);
    uint8_t *memory = malloc(*bytes);
    const bool ok = memory ? hs_kretz_read_bytes(kretz, 0, memory, err)
                           : hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu bytes", path, *bytes);
    free(memory);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_kretz(const char *path, const hs_kretz_options *options, size_t *bytes, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(path, options, err);
    const bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    if (kretz) *bytes = hs_kretz_bytes(kretz);
    hs_volume_free(&volume);
    hs_kretz_close(kretz);
    return ok;
}

static bool read_metaimage(const char *path, const hs_kretz_options *options, size_t *bytes, hs_error *err) {
    (void)options;
    hs_volume volume = {0};
    hs_metaimage *file = hs_metaimage_open(path, NULL, err);
    const bool ok = file && hs_metaimage_read_at(file, 0, &volume, err);
    if (ok) *bytes = hs_volume_count(&volume);
    hs_volume_free(&volume);
    hs_metaimage_close(file);
    return ok;
}

static bool shortest(reader read_it, const char *path, const hs_kretz_options *kretz, size_t *bytes,
                     double *ms, hs_error *err) {
    *ms = INFINITY;
    for (int turn = 0; turn < TURNS; turn++) {
        const double start = hs_now();
        if (!read_it(path, kretz, bytes, err)) return false;
        *ms = fmin(*ms, (hs_now() - start) * 1e3);
    }
    return true;
}

static void print_line(const char *what, double ms, double bytes_ms) {
    (void)printf("    %-26s %9.2f ms, %.2f times its bytes\n", what, ms, ms / bytes_ms);
}

/* Only a volume that was scanned by a probe has two grids to sample. */
static bool time_sampling(const char *path, const hs_kretz_options *options, hs_error *err) {
    hs_volume volume = {0};
    hs_kretz *kretz = hs_kretz_open(path, options, err);
    bool ok = kretz && hs_kretz_read(kretz, 0, &volume, err);
    hs_kretz_close(kretz);
    ok = ok && (!volume.beams || hs_info_sampling(&volume, err));
    hs_volume_free(&volume);
    return ok;
}

bool hs_info_timing(const char *path, const hs_kretz_options *kretz, hs_error *err) {
    const bool is_kretz = hs_kretz_is_file(path);
    double samples_ms = 0, volume_ms, bytes_ms;
    size_t bytes = SIZE_MAX;
    if (is_kretz && !shortest(read_samples, path, kretz, &bytes, &samples_ms, err)) return false;
    if (!shortest(is_kretz ? read_kretz : read_metaimage, path, kretz, &bytes, &volume_ms, err) ||
        !shortest(read_bytes, path, kretz, &bytes, &bytes_ms, err))
        return false;
    (void)printf("  reading it, the shortest of %d times:\n    %-26s %9.2f ms (%zu)\n", TURNS, "bytes",
                 bytes_ms, bytes);
    if (is_kretz) print_line("samples", samples_ms, bytes_ms);
    print_line(is_kretz ? "with the Cartesian copy" : "volume", volume_ms, bytes_ms);
    return !is_kretz || time_sampling(path, kretz, err);
}
