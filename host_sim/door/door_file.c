/* SPDX-License-Identifier: MIT */
/* A volume of a file. */
#include "door/door.h"
#include "loop/sequence.h"

#ifdef SVH_FILES

static bool check(const svh_file *how, hs_error *err) {
    return (how->probe < HS_PROBE_COUNT && how->scanned <= SVH_ZEROS) ||
           hs_fail(err, HS_ERR_USAGE, "svh_file: probe is %u and scanned %u, expected 0 .. 5 and 0 .. 2",
                   how->probe, how->scanned);
}

static hs_source_files options_of(const svh_file *how) {
    hs_source_files files = {.metaimage = {.padding = (hs_padding)how->scanned,
                                           .has_window = how->window[0] != how->window[1],
                                           .window_low = how->window[0],
                                           .window_high = how->window[1],
                                           .has_probe = how->probe_said != 0,
                                           .probe = (hs_probe)how->probe,
                                           .has_spacing = how->spacing[0] != 0.0},
                             .kretz = {.mirrored = how->mirrored != 0, .spacing = how->spacing[0]}};
    for (int a = 0; a < 3; a++) files.metaimage.spacing[a] = how->spacing[a];
    return files;
}

static bool read_file(svh_volume *volume, const char *path, const svh_file *how, hs_error *err) {
    const hs_source_files files = options_of(how);
    hs_sequence *sequence = hs_sequence_open(&path, 1, &files, err);
    if (!sequence) return false;
    const uint32_t count = hs_sequence_count(sequence);
    const bool ok =
        (how->number < count ||
         hs_fail(err, HS_ERR_USAGE, "%s: has %u volumes, so none of number %u", path, count, how->number)) &&
        hs_sequence_read(sequence, how->number, &volume->volume, err);
    const hs_levels *levels = hs_sequence_levels(sequence);
    volume->levels = levels ? *levels : (hs_levels){.low = 0.0, .high = 255.0};
    hs_sequence_close(sequence);
    return ok;
}

#else

static bool check(const svh_file *how, hs_error *err) {
    (void)how;
    (void)err;
    return true;
}

static bool read_file(svh_volume *volume, const char *path, const svh_file *how, hs_error *err) {
    (void)volume;
    (void)how;
    return hs_fail(err, HS_ERR_USAGE, "%s: this library was built without zlib, which reading files needs",
                   path);
}

#endif

int32_t svh_volume_read(svh_host *host, const char *path, const svh_file *how, svh_volume **out,
                        svh_error *error) {
    svh_file own = {0};
    hs_error err = {0};
    if (!DOOR_GIVEN(&err, host, path, out)) return door_leave(NULL, &err, error);
    *out = NULL;
    (void)pthread_mutex_lock(&host->lock);
    const bool good = (!how || DOOR_TAKE(svh_file, &own, how, &err)) && check(&own, &err);
    svh_volume *volume = good ? door_volume(host, &err) : NULL;
    door_hand_out(volume, volume && read_file(volume, path, &own, &err), out);
    return door_leave(host, &err, error);
}
