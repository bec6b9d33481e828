/* SPDX-License-Identifier: MIT */
/* The cost volume's sizes, for its definition and for the plugin (docs/cost_volume.md). */
#ifndef SV_COST_LAYOUT_H
#define SV_COST_LAYOUT_H

#include "cost/cost_shared.h"

#include <stdint.h>

/* Returns rays, bins and cells of a volume with sides of 1 to 8192, and every length in bins. `slice_mm`:
 * from one slice to the next; 0: unknown, and the longest side counts as 120 mm. */
sv_cost_layout sv_cost_layout_of(uint32_t width, uint32_t height, uint32_t slices, float slice_mm);

/* Returns the standard deviation of the lateral Gaussian, in cells. */
double sv_cost_sigma(const sv_cost_layout *layout);

#endif
