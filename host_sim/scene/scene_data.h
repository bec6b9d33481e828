/* SPDX-License-Identifier: MIT */
/* What a scene generates: volumes, and a ground truth that is exact by construction. */
#ifndef HS_SCENE_DATA_H
#define HS_SCENE_DATA_H

#include "volume/volume.h"

/* Values of the label map. */
enum { HS_LABEL_NEITHER = 0, HS_LABEL_SAC = 1, HS_LABEL_FETUS = 2 };

/* What a scene generates. Maps are nx * ny for the camera at 0, 0 (rays along +z), in source voxels:
 * depth 0 is the centre of the first slice. */
typedef struct {
    hs_volume full;  /* what the probe delivers */
    hs_volume truth; /* the same with everything before a correct clipping surface removed (set to 1) */
    uint8_t *label;  /* HS_LABEL_* */
    /* Nearest and farthest admissible clipping depth; NAN where the label is 0. Both are voxel centres, and
     * all voxels from near to far are fluid. A fetus that is touched by its occluder has no fluid before it:
     * near = far = the first voxel of the fetus. */
    float *near_end, *far_end;
    /* The clipping surface of `truth`: the middle of the interval, or deeper where an occluder beside the ray
     * ends deeper, always inside the interval; on label 0 carried on from the nearest pixel that has one.
     * Voxels z < clip are removed. */
    float *clip;
    /* hs_tissue of each voxel (host_sim/scene/scene_tissue.h), nx * ny * nz: what the truth was read from. */
    uint8_t *tissue;
} hs_scene_data;

/* Frees everything and zeroes the struct. Safe on a zeroed struct. */
void hs_scene_free(hs_scene_data *data);

#endif
