/* SPDX-License-Identifier: MIT */
/* Grey levels of a volume: the threshold between fluid and tissue, whether there is fluid at all. */
#ifndef REF_WALL_LEVELS_H
#define REF_WALL_LEVELS_H

#include "ref/ref_wall_blocks.h"

/* Histogram of the scanned blocks of one ray a cell: of four that overlap by half it tells as much as all.
 * The ray next to the median_of of the image, so a mirrored volume has the same histogram; both of a cell
 * that lies in the median_of. */
void sv_wall_histogram(const sv_wall_blocks *blocks, uint64_t histogram[256]);

typedef struct {
    bool two;           /* there are two classes: false if all blocks are equal, or there is none */
    uint32_t threshold; /* largest level of the dark class */
    uint32_t bright;    /* mean of the bright class, in units of 1 / SV_WALL_LEVEL_ONE */
    /* Counts of the smoothed histogram: the lowest between the classes' modes, and the lower mode; 1 and 1 if
     * that is 0. */
    uint64_t least, mode;
    double valley; /* their ratio */
    /* Variance of the levels' square roots times the blocks: between the means of the classes, within them.
     */
    uint64_t between, within;
} sv_wall_levels;

/* The classes are split midway between the means of their square roots, until the split no longer moves
 * (isodata). */
sv_wall_levels sv_wall_levels_of(const uint64_t histogram[256]);

/* Tissue is brighter than this level: layout->tissue of the side from the threshold to the mean of the bright
 * class, rounded down. */
uint32_t sv_wall_tissue_above(const sv_wall_layout *layout, const sv_wall_levels *levels);

/* True if the valley between the classes is so shallow that they may be one. */
bool sv_wall_is_shallow(const sv_wall_layout *layout, const sv_wall_levels *levels);

/* True if the variance between the classes is so much of all that there must be two. */
bool sv_wall_is_separable(const sv_wall_layout *layout, const sv_wall_levels *levels);

/* The level below which `rank` per mille of the histogram lie, in units of 1 / SV_WALL_LEVEL_ONE; a level's
 * count is spread evenly over level +- 0.5. */
uint32_t sv_wall_quantile(const uint64_t histogram[256], uint32_t rank);

#endif
