/* SPDX-License-Identifier: MIT */
/* The settings of the surface told by the wall, and what they become in one volume; for its definition and
 * for the plugin (docs/surface.md). */
#ifndef SV_WALL_LAYOUT_H
#define SV_WALL_LAYOUT_H

#include "wall/wall_shared.h"

#include <stdbool.h>
#include <stdint.h>

#define SV_WALL_EXTENT_MM 120.0

/* Every constant of the definition: lengths in mm, ratios and ranks. An experiment may change them. */
typedef struct {
    double block_mm;  /* side of a block */
    double beside_mm; /* brightness: the largest of the rays so far to either side */
    /* No fluid if the histogram's valley is higher than `valley` of its lower mode, fewer than `walled` of
     * the rays see a wall, and the classes make up at most `parted` of the variance of the levels. */
    double valley, walled, parted;
    double tissue;    /* tissue is this share of the way from the threshold to the mean of the bright class */
    double wall_rank; /* the wall's brightness among the brightnesses of first tissues */
    double low_rank, high_rank; /* the spread of the wall's brightness lies between these */
    double sure;                /* evidence per spread */
    double level;               /* spreads above the wall where any tissue is as likely the fetus as not */
    double first;    /* spreads more for the first tissue of a ray, and for what the wall encloses */
    double flank;    /* a cell behind fluid is the fetus beside the wall if it is with this probability */
    double one_side; /* share to which a first tissue with the fetus on one side is told like any other */
    double skin_mm;  /* bone of a first tissue lies this far behind its skin */
    double tau_mm;   /* distance to the fluid that costs 1 */
    /* Costs: the fetus is cut; an occluder is left; another fluid than the first. Together at most 31, or the
     * sums of the Gaussian leave 24 bits. */
    double cut, left, other;
    double sigma_mm;       /* lateral Gaussian over the costs */
    double slack;          /* layers that cost at most this much more than the cheapest are averaged */
    double reach;          /* the knob moves the surface over layers that cost at most so much more */
    double q;              /* the knob: 0 far, 0.5 the surface itself, 1 near */
    bool median;           /* of a ray and its eight neighbours */
    double aside_mm;       /* that lie so far aside */
    double around_mm;      /* the confidence is smoothed with neighbours so far aside */
    double doubt;          /* own cost at which a surface is as likely wrong as right */
    double fetus_share;    /* of the rays must show the fetus; else nothing is clipped */
    double wall_share;     /* of the rays must see a wall; else these two are assumed: */
    double assumed_wall;   /* its brightness in units of the bright class' mean */
    double assumed_spread; /* ln of the odds */
} sv_wall_settings;

/* The settings that docs/surface.md states. */
sv_wall_settings sv_wall_settings_default(void);

/* Distances between voxels for which the lengths are stated; others count as the nearest of these. */
#define SV_WALL_SHORTEST_MM 0.05
#define SV_WALL_LONGEST_MM  20.0

/* Sides of 1 .. 8192; spacing in mm along x, y and z, all three 0 if it is not known. */
sv_wall_layout sv_wall_layout_of(uint32_t width, uint32_t height, uint32_t slices, const double spacing_mm[3],
                                 const sv_wall_settings *settings);

/* The block around ray `ray` of `rays` along an axis of `voxels`: a ray's distance to either side, and at
 * least three quarters of a voxel. What lies beyond the border counts for the voxel at the border. An even
 * number of rays; ray i and ray rays - 1 - i are mirrored. */
sv_wall_span sv_wall_span_of(uint32_t ray, uint32_t voxels, uint32_t rays);

/* Square roots, ln of odds and the logistic function in fixed-point: the kernels get the same numbers. Signed
 * values in two's complement. */
void sv_wall_tables(uint32_t tables[SV_WALL_TABLE_WORDS]);

#endif
