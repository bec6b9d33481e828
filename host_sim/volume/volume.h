/* SPDX-License-Identifier: MIT */
/* A source volume as the host keeps it: 8-bit voxels on a regular grid, x fastest, then y, then z. */
#ifndef HS_VOLUME_H
#define HS_VOLUME_H

#include "base/error.h"
#include "volume/beams.h"
#include "volume/pose.h"

#include <stddef.h>
#include <stdint.h>

#define HS_VOLUME_MAX_AXIS   2048u               /* voxels along one axis */
#define HS_VOLUME_MAX_VOXELS (UINT64_C(1) << 31) /* voxels of a volume */

/*
 * Voxel (x, y, z) is voxels[(z * ny + y) * nx + x]; its centre stands at ((x + 0.5) * spacing[0], ...) mm
 * from the volume's corner. `pose` says where that is in the patient, `probe` from where it was scanned.
 *
 * The value 0 means "not scanned" (outside the fan) and nothing else: scanned voxels hold 1 .. 255. A reader
 * that meets zeros inside the scanned region raises them to 1 (hs_volume_mark_unscanned in volume_fill.h). So
 * the host can tell the plugin padding_value = 0.
 */
typedef struct {
    uint32_t nx, ny, nz;
    double spacing[3]; /* mm, > 0 */
    hs_pose pose;      /* of zeros: unknown, and seen from the probe as the default one is */
    hs_probe probe;
    uint8_t *voxels; /* nx * ny * nz bytes, owned */
    hs_beams *beams; /* in probe geometry, what this is the Cartesian copy of; owned; NULL: there is none */
    char name[256];  /* for messages and captions: a file's name or a scene's */
} hs_volume;

/* Allocates zeroed voxels, spacing 1 mm, the default pose, the probe at slice 0, empty name. What the struct
 * held before is overwritten, not freed. On failure the struct is all zero: HS_ERR_INPUT if a dimension is 0
 * or above HS_VOLUME_MAX_AXIS or if there are more than HS_VOLUME_MAX_VOXELS in all, HS_ERR_MEMORY if the
 * memory runs out. */
bool hs_volume_init(hs_volume *volume, uint32_t nx, uint32_t ny, uint32_t nz, hs_error *err);

/* Frees the voxels and the beams, and zeroes the struct. Safe on a zeroed struct. */
void hs_volume_free(hs_volume *volume);

/* Number of voxels. */
size_t hs_volume_count(const hs_volume *volume);

#endif
