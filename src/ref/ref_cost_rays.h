/* SPDX-License-Identifier: MIT */
/* Cost volume: the runs of tissue along a ray, which of them may be the fetus, and what every label costs. */
#ifndef SV_REF_COST_RAYS_H
#define SV_REF_COST_RAYS_H

#include "ref/ref_cost.h"

/* Everything that the costs of rays are taken from. */
typedef struct {
    const sv_ref_cost_layout *layout;
    const uint8_t *bins;
    sv_ref_cost_levels levels;
    const uint16_t *sums, *nearby;
    const uint8_t *wall, *back;
} sv_ref_cost_scan;

/* What a ray pays for every label. `open`: it has a fluid interval. False if it was not scanned. */
typedef struct {
    double cost[SV_COST_LABELS];
    double weight; /* of its vote, 0 .. 1: 1 but for what touches the wall */
    bool open;
} sv_ref_cost_ray;
bool sv_ref_cost_of_ray(const sv_ref_cost_scan *scan, uint32_t column, uint32_t row, sv_ref_cost_ray *out);

#endif
