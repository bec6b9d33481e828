/* SPDX-License-Identifier: MIT */
#include "volume/volume.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

bool hs_volume_init(hs_volume *volume, uint32_t nx, uint32_t ny, uint32_t nz, hs_error *err) {
    memset(volume, 0, sizeof *volume);
    const uint32_t size[3] = {nx, ny, nz};
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] == 0 || size[axis] > HS_VOLUME_MAX_AXIS)
            return hs_fail(err, HS_ERR_INPUT, "volume: size %c is %" PRIu32 ", expected 1 .. %u", "xyz"[axis],
                           size[axis], HS_VOLUME_MAX_AXIS);
        count *= size[axis];
    }
    if (count > HS_VOLUME_MAX_VOXELS)
        return hs_fail(err, HS_ERR_INPUT,
                       "volume: size %" PRIu32 " x %" PRIu32 " x %" PRIu32 " is %" PRIu64
                       " voxels, expected at most %" PRIu64,
                       nx, ny, nz, count, HS_VOLUME_MAX_VOXELS);
    uint8_t *voxels = calloc((size_t)count, 1);
    if (!voxels) return hs_fail(err, HS_ERR_MEMORY, "volume: no memory for %" PRIu64 " voxels", count);
    volume->nx = nx;
    volume->ny = ny;
    volume->nz = nz;
    for (int axis = 0; axis < 3; axis++) volume->spacing[axis] = 1.0;
    hs_pose_default(&volume->pose);
    volume->voxels = voxels;
    return true;
}

void hs_volume_free(hs_volume *volume) {
    free(volume->voxels);
    hs_beams_free(volume->beams);
    memset(volume, 0, sizeof *volume);
}

size_t hs_volume_count(const hs_volume *volume) {
    return (size_t)volume->nx * volume->ny * volume->nz;
}
