/* SPDX-License-Identifier: MIT */
/* How bright the wall is, and how likely tissue of a brightness is the fetus. */
#ifndef REF_WALL_EVIDENCE_H
#define REF_WALL_EVIDENCE_H

#include "ref/ref_wall_levels.h"

typedef struct {
    uint32_t rays, wall_rays;
    uint32_t wall;                   /* grey level, in units of 1 / SV_WALL_LEVEL_ONE */
    int32_t spread;                  /* ln of the odds, fixed-point */
    uint32_t first[256], other[256]; /* brightness to probability: the first tissue of a ray, any other */
} sv_wall_evidence;

/* Marks the slices first .. end - 1 of a ray that are tissue: brighter than the threshold, and not in a run
 * thinner than layout->thin. `tissue` has one byte a slice of the volume; 0 outside the scan. */
void sv_wall_tissue(const sv_wall_volume *volume, const sv_wall_layout *layout, uint32_t threshold,
                    size_t pixel, uint8_t *tissue);

/* The first tissue of a ray: slices [begin, end). False if it has none. `touches`: it begins within a gap
 * from the start of the scan. `fluid` slices of fluid follow it. */
typedef struct {
    uint32_t begin, end, fluid;
    bool touches;
} sv_wall_run;
bool sv_wall_first_run(const sv_wall_volume *volume, const sv_wall_layout *layout, size_t pixel,
                       const uint8_t *tissue, sv_wall_run *out);

/* `bright` holds the brightness of every voxel (sv_wall_brightest). False: no memory. */
bool sv_wall_evidence_of(const sv_wall_volume *volume, const sv_wall_layout *layout,
                         const sv_wall_levels *levels, const uint8_t *bright, sv_wall_evidence *out);

#endif
