/* SPDX-License-Identifier: MIT */
/* What rays pay for being clipped at every layer. */
#ifndef REF_WALL_RAYS_H
#define REF_WALL_RAYS_H

#include "ref/ref_wall_evidence.h"

/* Costs in units of 1 / SV_WALL_COST_ONE: cell c clipped at layer z at [c * layers + z]. The mean of the
 * cell's two by two rays, rounded half up; a ray that was not scanned costs nothing. */
typedef struct {
    uint32_t *all;  /* the distance to the fluid; the fetus is cut, an occluder is left, another fluid */
    uint32_t *away; /* of that, the distance to the fluid */
    uint64_t fetus; /* sum over the rays of the probability that the fetus is on them */
} sv_wall_costs;

/* False: no memory. */
bool sv_wall_costs_create(const sv_wall_scan *scan, const sv_wall_evidence *evidence, sv_wall_costs *costs);
void sv_wall_costs_destroy(sv_wall_costs *costs);

#endif
