/* SPDX-License-Identifier: MIT */
/* Grey levels of a volume: local means, the threshold between fluid and tissue, whether there is fluid at
 * all. */
#ifndef REF_WALL_LEVELS_H
#define REF_WALL_LEVELS_H

#include "ref/ref_wall_volume.h"

/* Means of boxes, rounded half up; what was not scanned counts as 0. One a voxel. False: no memory. */
bool sv_wall_means(const sv_wall_volume *volume, const sv_wall_layout *layout, uint8_t *means);

/* Largest mean beside the ray in the same slice. In place. False: no memory. */
bool sv_wall_brightest(const sv_wall_layout *layout, uint8_t *means);

/* Histogram of the means of boxes that were scanned all over: at a border the mean tells how much was not. */
void sv_wall_histogram(const sv_wall_volume *volume, const sv_wall_layout *layout, const uint8_t *means,
                       uint64_t histogram[256]);

typedef struct {
    bool two;           /* there are two classes: false if all means are equal, or there is none */
    uint32_t threshold; /* largest level of the dark class */
    uint32_t bright;    /* mean of the bright class, in units of 1 / SV_WALL_LEVEL_ONE */
    /* Counts of the smoothed histogram: the lowest between the classes' modes, and the lower mode; 1 and 1 if
     * that is 0. */
    uint64_t least, mode;
    double valley; /* their ratio */
} sv_wall_levels;

/* The classes are split midway between the means of their square roots, until the split no longer moves
 * (isodata). */
sv_wall_levels sv_wall_levels_of(const uint64_t histogram[256]);

/* No fluid if the valley is shallow. */
sv_wall_outcome sv_wall_outcome_of(const sv_wall_layout *layout, const sv_wall_levels *levels);

/* The level below which `rank` per mille of the histogram lie, in units of 1 / SV_WALL_LEVEL_ONE; a level's
 * count is spread evenly over level +- 0.5. */
uint32_t sv_wall_quantile(const uint64_t histogram[256], uint32_t rank);

#endif
