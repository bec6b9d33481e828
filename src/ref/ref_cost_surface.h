/* SPDX-License-Identifier: MIT */
/* Cost volume: from the bins of a volume to its surface. */
#ifndef SV_REF_COST_SURFACE_H
#define SV_REF_COST_SURFACE_H

#include "ref/ref_cost_rays.h"
#include "ref/ref_method.h"

typedef struct {
    sv_ref_cost_levels levels;
    uint32_t rays; /* scanned ones */
    uint32_t open; /* with a fluid interval */
    /* Pixels near a cell where two labels, or a label and the edge of the minimum, are within 1e-5. */
    uint32_t ties;
} sv_ref_cost_facts;

/* Everything: both ends of the q range, float64 slices, the confidence 0 .. 1, and 1 in `tie` for pixels that
 * a tie can reach. Maps are width * height. `tie` and `facts` may be NULL. False if memory runs out. */
bool sv_ref_cost_surface(const sv_ref_volume *volume, float slice_mm, double *near_surface,
                         double *far_surface, double *confidence, uint8_t *tie, sv_ref_cost_facts *facts);

/* The same with a changed layout. */
bool sv_ref_cost_surface_with(const sv_ref_volume *volume, const sv_ref_cost_layout *layout,
                              double *near_surface, double *far_surface, double *confidence, uint8_t *tie,
                              sv_ref_cost_facts *facts);

/* The blurred cost volume, cells_x * cells_y * SV_COST_VALUES, from bins; the caller frees it.
 * NULL: no memory. */
double *sv_ref_cost_volume(const uint8_t *bins, const sv_ref_cost_layout *layout, sv_ref_cost_facts *facts);

/* The plugin's method. */
extern const sv_ref_method sv_ref_method_cost;

#endif
