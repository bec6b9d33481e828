/* SPDX-License-Identifier: MIT */
/*
 * The cost volume in float64, from its written definition (docs/cost_volume.md): sizes, bins, grey levels,
 * brightness, and where wall and back of the sac lie. Constants are SV_COST_*.
 */
#ifndef SV_REF_COST_H
#define SV_REF_COST_H

#include "cost_layout.h"
#include "ref/ref_volume.h"

#include <stdbool.h>

/* The sizes, and what an experiment may change; lengths in bins. */
typedef struct {
    sv_cost_layout sizes;
    double sigma;                  /* of the lateral Gaussian, in cells */
    double thick_from, thick_full; /* thickness that begins to count, and that counts in full */
    double tau, cut, left, other, thick, behind_penalty, slack, viewer_shift;
    bool bone_splits; /* false: runs stay whole */
    bool median;      /* false: the cells' minima as they are */
    int level;        /* T_L as a grey level; 0: from the histogram */
    double memory;    /* share of the frame before, 0 .. 1 */

    /* cells_x * cells_y * SV_COST_VALUES, zeros at first, kept by the caller; NULL: no memory. */
    double *previous;
} sv_ref_cost_layout;

/* The values that the plugin uses, SV_COST_*. */
sv_ref_cost_layout sv_ref_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices, float slice_mm);

/* Bin l of a ray, at bins[(l * rows + row) * columns + column]: the mean of the scanned voxels among shrink *
 * shrink * bin_slices, rounded half up, at least 1; 0 if none was scanned. */
void sv_ref_cost_bins(const sv_ref_volume *volume, const sv_ref_cost_layout *layout, uint8_t *bins);

/* Grey levels of the bins. The threshold between the dark and the bright class lies midway between their
 * means (isodata thresholding), over the bins of every row of cells' middle row of rays. */
typedef struct {
    /* T_L: a sixth of the way from the mean of the dark class to that of the bright one; 0 if that is less
     * than twice as bright: then there is no fluid. */
    uint32_t fluid;
    uint32_t bright; /* mean of the bright class */
} sv_ref_cost_levels;
sv_ref_cost_levels sv_ref_cost_levels_of(const uint8_t *bins, const sv_ref_cost_layout *layout);

/* Sums over 3 x 3 x 3 bins (0 beyond the volume), and the largest of those within `lateral` rays and `axial`
 * bins. Both as many as the bins. False: no memory. */
bool sv_ref_cost_brightness(const uint8_t *bins, const sv_ref_cost_layout *layout, uint16_t *sums,
                            uint16_t *nearby);

/* Bins at which, in most of a cell's neighbourhood, the fluid begins behind the wall (0: nowhere), and ends
 * before the back (labels: nowhere). One a cell. False: no memory. */
bool sv_ref_cost_walls(const uint8_t *bins, const sv_ref_cost_layout *layout, uint32_t level, uint8_t *wall,
                       uint8_t *back);

#endif
