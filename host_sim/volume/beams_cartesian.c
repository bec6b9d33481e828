/* SPDX-License-Identifier: MIT */
#include "volume/beams_cartesian.h"

#include "base/threads.h"

#include <math.h>
#include <string.h>

#define WHOLE 1e-9 /* of a voxel: a side of 2.0000000001 voxels is 2 of them */

static double default_spacing(const hs_beams *beams, const double side[3]) {
    return fmax(beams->pitch, fmax(side[0], fmax(side[1], side[2])) / HS_CARTESIAN_AXIS);
}

bool hs_beams_cartesian_init(hs_volume *volume, hs_beams *beams, double spacing, hs_error *err) {
    double low[3], high[3], side[3];
    uint32_t count[3];
    hs_beams_box(beams, low, high);
    for (int a = 0; a < 3; a++) side[a] = high[a] - low[a];
    if (spacing == 0.0) spacing = default_spacing(beams, side);
    memset(volume, 0, sizeof *volume);
    for (int a = 0; a < 3; a++) {
        const double voxels = fmax(ceil(side[a] / spacing - WHOLE), 1.0);
        if (!(voxels <= HS_VOLUME_MAX_AXIS))
            return hs_fail(err, HS_ERR_USAGE,
                           "spacing of %g mm: %.0f voxels along %c, expected at most %u (%g mm are scanned)",
                           spacing, voxels, "xyz"[a], HS_VOLUME_MAX_AXIS, side[a]);
        count[a] = (uint32_t)voxels;
        beams->corner[a] = 0.5 * (low[a] + high[a]) - 0.5 * voxels * spacing;
    }
    if (!hs_volume_init(volume, count[0], count[1], count[2], err)) return false;
    for (int a = 0; a < 3; a++) {
        volume->spacing[a] = spacing;
        volume->pose.origin[a] = beams->corner[a] + 0.5 * spacing;
    }
    volume->beams = beams;
    return true;
}

static void fill_row(const hs_volume *volume, double plane, double depth, uint8_t *row) {
    const hs_beams *beams = volume->beams;
    double index[3] = {0.0, 0.0, plane};
    for (uint32_t x = 0; x < volume->nx; x++) {
        const double place = beams->corner[0] + (x + 0.5) * volume->spacing[0];
        if (!hs_beams_locate_in_plane(beams, place, depth, index)) continue;
        const double level = floor(hs_beams_sample(beams, index) + 0.5);
        row[x] = level < 1.0 ? 1 : (uint8_t)level;
    }
}

/* All rows of one y. From one slice to the next the samples are neighbours in the same lines, so that the
 * cache holds most of them; from one y to the next they lie in other planes. */
static void fill_layer(void *context, uint32_t y) {
    const hs_volume *volume = context;
    const hs_beams *beams = volume->beams;
    const double place = beams->corner[1] + (y + 0.5) * volume->spacing[1];
    for (uint32_t z = 0; z < volume->nz; z++) {
        uint8_t *row = volume->voxels + ((size_t)z * volume->ny + y) * volume->nx;
        double depth;
        const double plane =
            hs_beams_locate_plane(beams, place, beams->corner[2] + (z + 0.5) * volume->spacing[2], &depth);
        memset(row, 0, volume->nx);
        if (plane >= 0.0) fill_row(volume, plane, depth, row);
    }
}

void hs_beams_cartesian_fill(hs_volume *volume) {
    hs_parallel(hs_thread_count(0), volume->ny, fill_layer, volume);
}
