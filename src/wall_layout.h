/* SPDX-License-Identifier: MIT */
/* The settings of the surface told by the wall, and what they become in one volume; for its definition and
 * for the plugin (docs/surface.md). */
#pragma once

#include "wall/wall_shared.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Every constant of the definition, with the value that docs/surface.md states: lengths in mm, ratios and
 * ranks. */
/* clang-format off */
#define SV_WALL_CONSTANTS(CONSTANT) \
    CONSTANT(block_mm, 2.0) /* side of a block */ \
    CONSTANT(beam_mm, 3.0) /* between the rays of the grid along the beams, about its middle */ \
    CONSTANT(dilation_mm, 3.75) /* a cell's brightness is the maximum over cells so far to either side */ \
    /* What is bright is told within so many mm to either side, along every axis. The mean of all that is
     * bright counts as such a share of the blocks there. */ \
    CONSTANT(window_mm, 10.0) \
    CONSTANT(bright_share, 0.05) \
    CONSTANT(dark_rank, 0.05) /* such a share of the blocks is darker than the dark level */ \
    CONSTANT(threshold, 0.65) /* its root is this share of the way from the dark level's to the bright */ \
    CONSTANT(valley, 0.75) /* what is darker than this share of both sides parts a limb from the wall */ \
    CONSTANT(dim, 0.4) /* a block that is brighter than this share of the threshold is dim, not dark */ \
    /* Of the darkest `fluid_rank` of all blocks, the share in the gaps that the surface lies in tells whether
     * there is fluid in front of the fetus: there is from `gap_share` on, there is none below
     * `doubtful_share`, and between them it is doubtful. */ \
    CONSTANT(fluid_rank, 0.2) \
    CONSTANT(gap_share, 0.3) \
    CONSTANT(doubtful_share, 0.12) \
    /* Limits of shares are so far in favour of the outcome of the frame that this one continues, so that an
     * answer does not flicker. */ \
    CONSTANT(hysteresis, 0.02) \
    CONSTANT(doubtful_confidence, 0.3) /* of a doubtful surface where a certain one has 1 */ \
    CONSTANT(opening_mm, 24.0) /* the least pit of a doubtful surface; of a certain one a part of it */ \
    CONSTANT(tail_rank, 0.1) /* the spread of the wall's brightness leaves such a share on either side */ \
    CONSTANT(slope, 6.0) /* of the logistic function, per spread */ \
    CONSTANT(fetus_level, 0.4) /* spreads above the wall where the probability of the fetus is one half */ \
    CONSTANT(first_run_extra, 0.95) /* spreads more for the first run of a ray, and for enclosed tissue */ \
    CONSTANT(one_side, 0.3) /* weight of the general probability if it is reached from one side only */ \
    CONSTANT(skin_mm, 5.5) /* it tells nothing of the run that it begins; bone lies that far behind it */ \
    /* Distance to the fluid that costs 1. Darkness at the start of a ray's scan that is at most so deep is no
     * fluid, if at least a fifth of the rays begin with that. */ \
    CONSTANT(tau_mm, 7.0) \
    /* The costs of cutting the fetus and of leaving an occluder. Another fluid than the first costs 1 where
     * no fetus is seen. The sum of all is at most 31, or the sums of the Gaussian leave 24 bits. */ \
    CONSTANT(cut_cost, 15.0) \
    CONSTANT(occluder_cost, 8.0) \
    CONSTANT(sigma_mm, 2.9) /* lateral Gaussian over the costs; rays of the median are twice as far apart */ \
    /* Layers that cost at most this much more than the minimum are averaged, and the knob moves the surface
     * over those that cost at most half of it more. */ \
    CONSTANT(average_margin, 0.5) \
    CONSTANT(q, 0.5) /* the knob: 0 far, 0.5 the surface itself, 1 near */ \
    /* Cost of the surface at which the confidence is one half; for that, a surface in a layer as bright as
     * the threshold costs 1 more. */ \
    CONSTANT(half_confidence_cost, 5.5) \
    /* So many rays must show the fetus, or nothing is clipped; and so many a wall, or the next two are
     * assumed. */ \
    CONSTANT(seen_share, 0.1) \
    CONSTANT(clear_share, 0.45) /* from this share in gaps on, a fetus need not be brighter than the wall */ \
    CONSTANT(assumed_wall, 0.6) /* brightness of the wall in units of the bright class' mean */ \
    CONSTANT(assumed_spread, 0.5) /* its spread, ln of the odds */
/* clang-format on */

/* An experiment may change them. */
typedef struct {
#define SV_WALL_FIELD(name, value) double name;
    SV_WALL_CONSTANTS(SV_WALL_FIELD)
#undef SV_WALL_FIELD
    sv_wall_outcome last; /* of the frame that this one continues; SV_WALL_EMPTY: there was none */
    bool clip_doubtful;   /* clip at a doubtful surface, too; and where there is no fluid, it is doubtful */
    bool median;          /* take the median of a ray and its eight neighbours */
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

/* Cells of a grid and of all coarser ones, each half as wide as the one before, down to one cell. */
size_t sv_wall_pyramid_cells(uint32_t columns, uint32_t rows);

/* Square roots, ln of odds and the logistic function in fixed-point: the kernels get the same numbers. Signed
 * values in two's complement. */
void sv_wall_tables(uint32_t tables[SV_WALL_TABLE_WORDS]);
