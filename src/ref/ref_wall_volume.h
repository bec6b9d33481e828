/* SPDX-License-Identifier: MIT */
/* The volume that the definition of the surface told by the wall reads. */
#ifndef REF_WALL_VOLUME_H
#define REF_WALL_VOLUME_H

#include "wall_layout.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A camera-aligned volume: voxel (x, y, z) at voxels[(z * height + y) * width + x], z away from the probe.
 * Borrowed. */
typedef struct {
    const uint8_t *voxels;
    uint32_t width, height, slices; /* 1 .. 8192 each */
    /* Ray (x, y) was scanned in slices first[y * width + x] .. end[y * width + x] - 1; first = end: not at
     * all. Voxels outside that range are not read. Both NULL: everything was scanned. */
    const uint16_t *first, *end;
    /* Along x, y and z, 0.05 .. 20. All three 0: not known; then the longest side counts as
     * SV_WALL_EXTENT_MM. */
    double spacing_mm[3];
} sv_wall_volume;

/* First scanned slice of a ray and the first one behind the scan. */
uint32_t sv_wall_first(const sv_wall_volume *volume, size_t pixel);
uint32_t sv_wall_end(const sv_wall_volume *volume, size_t pixel);

/* True if sizes, spacing and ranges are as stated above; else the text names field and value. */
bool sv_wall_check(const sv_wall_volume *volume, char *text, size_t size);

#endif
