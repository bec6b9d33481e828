/* SPDX-License-Identifier: MIT */
#include "volume/metaimage.h"

#include <math.h>
#include <stdlib.h>

/* Reads one map; its values are slices of the volume. */
static bool read_map(const char *path, const hs_volume *volume, double *map, hs_error *err) {
    if (!hs_metaimage_read_map(path, volume->nx, volume->ny, map, err)) return false;
    const size_t count = (size_t)volume->nx * volume->ny;
    for (size_t i = 0; i < count; i++)
        if (!(map[i] >= 0.0 && map[i] <= volume->nz) || map[i] != floor(map[i]))
            return hs_fail(
                err, HS_ERR_INPUT,
                "%s: pixel (%zu, %zu) is %g, expected a slice of the volume, a whole number 0 .. %u", path,
                i % volume->nx, i / volume->nx, map[i], volume->nz);
    return true;
}

static void mark(hs_volume *volume, const double *first, const double *end) {
    const size_t pixels = (size_t)volume->nx * volume->ny;
    for (uint32_t z = 0; z < volume->nz; z++) {
        uint8_t *slice = volume->voxels + z * pixels;
        for (size_t i = 0; i < pixels; i++) {
            const bool scanned = first[i] <= z && z < end[i];
            if (!scanned)
                slice[i] = 0;
            else if (slice[i] == 0)
                slice[i] = 1;
        }
    }
}

bool hs_scanned_maps_apply(hs_volume *volume, const char *first, const char *end, hs_error *err) {
    const size_t pixels = (size_t)volume->nx * volume->ny;
    double *maps = calloc(2 * pixels, sizeof *maps);
    if (!maps) return hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a map of %zu pixels", first, pixels);
    const bool ok = read_map(first, volume, maps, err) && read_map(end, volume, maps + pixels, err);
    if (ok) mark(volume, maps, maps + pixels);
    free(maps);
    return ok;
}
