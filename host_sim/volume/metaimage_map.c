/* SPDX-License-Identifier: MIT */
/* Maps beside a volume: a value a pixel, and what of each column was scanned. */
#include "volume/metaimage.h"
#include "volume/metaimage_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hs_metaimage_read_map(const char *path, uint32_t nx, uint32_t ny, double *values, hs_error *err) {
    hs_met_voxels *voxels = hs_met_voxels_open(path, NULL, err);
    if (!voxels) return false;
    const hs_met_header *h = hs_met_voxels_header(voxels);
    const size_t count = (size_t)nx * ny;
    hs_met_room room;
    bool ok = (h->size[0] == nx && h->size[1] == ny && h->size[2] == 1 && h->frames == 1) ||
              hs_fail(err, HS_ERR_INPUT, "%s:%u: DimSize is %s, expected %u %u 1", path, h->dim_line,
                      h->size_text, nx, ny);
    for (size_t first = 0; ok && first < count; first += HS_MET_CHUNK) {
        const size_t n = count - first < HS_MET_CHUNK ? count - first : HS_MET_CHUNK;
        ok = hs_met_voxels_read_at(voxels, first, n, &room, err);
        if (ok) memcpy(values + first, room.value, n * sizeof *values);
    }
    ok = ok && hs_met_voxels_finish(voxels, err);
    hs_met_voxels_close(voxels);
    return ok;
}

float *hs_metaimage_load_map(const char *path, uint32_t nx, uint32_t ny, hs_error *err) {
    const size_t count = (size_t)nx * ny;
    double *values = hs_memory(count, sizeof *values, path, err);
    float *map = values ? hs_memory(count, sizeof *map, path, err) : NULL;
    bool ok = map && hs_metaimage_read_map(path, nx, ny, values, err);
    for (size_t i = 0; ok && i < count; i++) {
        map[i] = (float)values[i];
        ok = isfinite(map[i]) ||
             hs_fail(err, HS_ERR_INPUT, "%s: value %zu is %g, expected a finite float32", path, i, values[i]);
    }
    free(values);
    if (ok) return map;
    free(map);
    return NULL;
}

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

void hs_scanned_maps_mark(hs_volume *volume, const double *maps) {
    const size_t pixels = (size_t)volume->nx * volume->ny;
    for (uint32_t z = 0; z < volume->nz; z++) {
        uint8_t *slice = volume->voxels + z * pixels;
        for (size_t i = 0; i < pixels; i++) {
            const bool scanned = maps[i] <= z && z < maps[pixels + i];
            if (!scanned)
                slice[i] = 0;
            else if (slice[i] == 0)
                slice[i] = 1;
        }
    }
}

double *hs_scanned_maps_load(const hs_volume *shape, const char *first, const char *end, hs_error *err) {
    const size_t pixels = (size_t)shape->nx * shape->ny;
    double *maps = calloc(2 * pixels, sizeof *maps);
    if (!maps)
        (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for a map of %zu pixels", first, pixels);
    else if (read_map(first, shape, maps, err) && read_map(end, shape, maps + pixels, err))
        return maps;
    free(maps);
    return NULL;
}
