/* SPDX-License-Identifier: MIT */
/* The settings of the surface told by the wall, and what they become in one volume; for its definition and
 * for the plugin (docs/surface.md). */
#ifndef SV_WALL_LAYOUT_H
#define SV_WALL_LAYOUT_H

#include "wall/wall_shared.h"

#include <stdbool.h>
#include <stdint.h>

/* Every constant of the definition: lengths in mm, ratios and ranks. An experiment may change them. */
typedef struct {
    double block_mm;    /* side of a block */
    double beam_mm;     /* between the rays of the grid along the beams, about its middle */
    double dilation_mm; /* a cell's brightness is the maximum over the cells so far to either side */
    /* What is bright is told within so many mm to either side, along every axis. The mean of all that is
     * bright counts as such a share of the blocks there. */
    double window_mm, bright_share;
    double dark_rank; /* such a share of the blocks is darker than the dark level */
    double threshold; /* the threshold's root is this share of the way from the dark level's to the bright */
    double dim;       /* a block that is brighter than this share of the threshold is dim, not dark */
    /* Of the darkest `fluid_rank` of all blocks, the share in the gaps that the surface lies in tells whether
     * there is fluid in front of the fetus: there is from `gap_share` on, there is none below
     * `doubtful_share`, and between them it is doubtful. */
    double fluid_rank, gap_share, doubtful_share;
    /* Limits of shares are so far in favour of the outcome of the frame that this one continues, so that an
     * answer does not flicker. SV_WALL_EMPTY: there was none. */
    double hysteresis;
    sv_wall_outcome last;
    double doubtful_confidence; /* of a doubtful surface where a certain one has 1 */
    double opening_mm; /* a doubtful surface has no pit narrower than this, a certain one than a part of it */
    bool clip_doubtful;     /* clip at a doubtful surface, too; and where there is no fluid, it is doubtful */
    double tail_rank;       /* the spread of the wall's brightness leaves such a share on either side */
    double slope;           /* of the logistic function, per spread */
    double fetus_level;     /* spreads above the wall where the probability of the fetus is one half */
    double first_run_extra; /* spreads more for the first run of a ray, and for enclosed tissue */
    double one_side;        /* weight of the general probability if the fetus is reached from one side only */
    /* So deep is skin, which tells nothing of the run that begins with it; bone lies that far behind it. */
    double skin_mm;
    /* Distance to the fluid that costs 1. Darkness at the start of a ray's scan that is at most so deep is no
     * fluid, if at least half of the rays begin with that. */
    double tau_mm;
    /* The costs of cutting the fetus and of leaving an occluder. Another fluid than the first costs 1 where
     * no fetus is seen. The sum of all is at most 31, or the sums of the Gaussian leave 24 bits. */
    double cut_cost, occluder_cost;
    double sigma_mm; /* lateral Gaussian over the costs; rays of the median are twice as far apart */
    /* Layers that cost at most this much more than the minimum are averaged, and the knob moves the surface
     * over those that cost at most half of it more. */
    double average_margin;
    double q;    /* the knob: 0 far, 0.5 the surface itself, 1 near */
    bool median; /* take the median of a ray and its eight neighbours */
    /* Cost of the surface at which the confidence is one half; for that, a surface in a layer as bright as
     * the threshold costs 1 more. */
    double half_confidence_cost;
    /* So many rays must show the fetus, or nothing is clipped; and so many a wall, or the next two are
     * assumed. */
    double seen_share, beam_seen_share; /* the latter along the beams */
    double assumed_wall;                /* brightness of the wall in units of the bright class' mean */
    double assumed_spread;              /* its spread, ln of the odds */
} sv_wall_settings;

/* The settings that docs/surface.md states. */
sv_wall_settings sv_wall_settings_default(void);

/* Distances between voxels for which the lengths are stated; others count as the nearest of these. */
#define SV_WALL_SHORTEST_MM 0.05
#define SV_WALL_LONGEST_MM  20.0

/* Sides of 1 .. 8192; spacing in mm along x, y and z, all three 0 if it is not known. */
sv_wall_layout sv_wall_layout_of(uint32_t width, uint32_t height, uint32_t slices, const double spacing_mm[3],
                                 const sv_wall_settings *settings);

/* The spacing that counts: one that is not known is assumed, and one out of range is clamped. */
void sv_wall_spacing_of(const sv_wall_layout *layout, const double given_mm[3], double mm[3]);

/* The layout of a grid whose blocks lie so far apart: a ray a column and a row, a layer a slice. */
sv_wall_layout sv_wall_layout_of_grid(uint32_t lines, uint32_t planes, uint32_t samples, double ray_mm,
                                      double layer_mm, const sv_wall_settings *settings);

/* The block around ray `ray` of `rays` along an axis of `voxels`: a ray's distance to either side, and at
 * least three quarters of a voxel. What lies beyond the border counts for the voxel at the border. An even
 * number of rays; ray i and ray rays - 1 - i are mirrored. */
sv_wall_span sv_wall_span_of(uint32_t ray, uint32_t voxels, uint32_t rays);

/* Arranges the spans of the rays x .. x + SV_WALL_TOGETHER - 1, as far as there are so many, for vectors. */
sv_wall_taps sv_wall_taps_of(const sv_wall_span *spans, uint32_t x, uint32_t rays);

/* Square roots, ln of odds and the logistic function in fixed-point: the kernels get the same numbers. Signed
 * values in two's complement. */
void sv_wall_tables(uint32_t tables[SV_WALL_TABLE_WORDS]);

#endif
