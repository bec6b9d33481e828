/* SPDX-License-Identifier: MIT */
/*
 * The cost volume in float64, from its written definition (docs/cost_volume.md). Constants are SV_COST_*.
 * Functions that allocate return false or NULL if memory runs out.
 */
#ifndef SV_REF_COST_H
#define SV_REF_COST_H

#include "cost_layout.h"
#include "ref/ref_method.h"

/* ---- sizes, bins, grey levels, brightness, wall and back of the sac (ref_cost.c) */

/* The sizes, and what an experiment may change; lengths in bins. */
typedef struct {
    sv_cost_layout sizes;
    double sigma;                  /* of the lateral Gaussian, in cells */
    double thick_from, thick_full; /* thickness that begins to count, and that counts in full */
    double tau, cut_cost, occluder_cost, wrong_fluid_cost, thick, behind_penalty, average_margin,
        viewer_shift;
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

/* Writes two numbers for each bin: the sum over 3 x 3 x 3 bins, 0 beyond the volume, and the maximum of the
 * sums within `lateral` rays and `axial` bins. */
bool sv_ref_cost_brightness(const uint8_t *bins, const sv_ref_cost_layout *layout, uint16_t *sums,
                            uint16_t *nearby);

/* Writes two bins for each cell: where, in most of its neighbourhood, the fluid begins behind the wall (0:
 * nowhere), and where it ends in front of the back (labels: nowhere). */
bool sv_ref_cost_walls(const uint8_t *bins, const sv_ref_cost_layout *layout, uint32_t level, uint8_t *wall,
                       uint8_t *back);

/* ---- what a ray pays (ref_cost_rays.c) */

/* Everything that the costs of rays are taken from. */
typedef struct {
    const sv_ref_cost_layout *layout;
    const uint8_t *bins;
    sv_ref_cost_levels levels;
    const uint16_t *sums, *nearby;
    const uint8_t *wall, *back;
} sv_ref_cost_scan;

/* What a ray pays for every label. */
typedef struct {
    double cost[SV_COST_LABELS];
    double weight; /* of its vote, 0 .. 1: 1 but for what touches the wall */
    bool open;     /* it has a fluid interval */
} sv_ref_cost_ray;

/* False if the ray was not scanned. */
bool sv_ref_cost_of_ray(const sv_ref_cost_scan *scan, uint32_t column, uint32_t row, sv_ref_cost_ray *out);

/* ---- from the bins of a volume to its surface (ref_cost_surface.c) */

typedef struct {
    sv_ref_cost_levels levels;
    uint32_t rays; /* scanned ones */
    uint32_t open; /* with a fluid interval */
    /* Pixels near a cell where two labels, or a label and the edge of the minimum, are within 1e-5. */
    uint32_t ties;
} sv_ref_cost_facts;

/* Writes the surfaces at both ends of the q range, in slices, the confidence 0 .. 1, and 1 in `tie` for
 * pixels that a tie can reach. Maps are width * height. `tie` and `facts` may be NULL. */
bool sv_ref_cost_surface(const sv_ref_volume *volume, float slice_mm, double *near_surface,
                         double *far_surface, double *confidence, uint8_t *tie, sv_ref_cost_facts *facts);

/* Does so with a changed layout. */
bool sv_ref_cost_surface_with(const sv_ref_volume *volume, const sv_ref_cost_layout *layout,
                              double *near_surface, double *far_surface, double *confidence, uint8_t *tie,
                              sv_ref_cost_facts *facts);

/* Returns the blurred cost volume, cells_x * cells_y * SV_COST_VALUES, from bins; the caller frees it. */
double *sv_ref_cost_volume(const uint8_t *bins, const sv_ref_cost_layout *layout, sv_ref_cost_facts *facts);

#endif
