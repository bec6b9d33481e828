/* Grey levels of a volume: local means, the threshold between fluid and tissue, whether there is fluid at
 * all. */
#ifndef REF_WALL_LEVELS_H
#define REF_WALL_LEVELS_H

#include "ref/ref_wall_layout.h"

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
    double bright;      /* mean of the bright class */
    double valley;      /* lowest count between the classes' modes / count of the lower mode */
} sv_wall_levels;

/* The classes are split midway between the means of their square roots, until the split no longer moves
 * (isodata). */
sv_wall_levels sv_wall_levels_of(const uint64_t histogram[256]);

/* The level below which `rank` (0 .. 1) of the histogram lies; a level's count is spread evenly over level +-
 * 0.5. */
double sv_wall_quantile(const uint64_t histogram[256], double rank);

#endif
