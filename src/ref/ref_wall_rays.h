/* SPDX-License-Identifier: MIT */
/* What a ray pays for being clipped at every label. */
#ifndef REF_WALL_RAYS_H
#define REF_WALL_RAYS_H

#include "ref/ref_wall_evidence.h"

/* Everything the costs are taken from. Borrowed. */
typedef struct {
    const sv_wall_volume *volume;
    const sv_wall_layout *layout;
    const sv_wall_evidence *evidence;
    uint32_t threshold;
    const uint8_t *bright;
} sv_wall_scan;

/* One ray: arrays by slice. Allocated once for all rays. */
typedef struct {
    uint8_t *tissue;
    uint32_t *begun; /* slices + 1: probability that the fetus begins before the slice */
    uint32_t
        *later; /* slices + 1: probability that it begins with a run whose fluid begins behind the slice */
    uint32_t *distance; /* to the ray's fluid, slices; UINT32_MAX: there is none */
} sv_wall_ray;
bool sv_wall_ray_create(const sv_wall_layout *layout, sv_wall_ray *ray);
void sv_wall_ray_destroy(sv_wall_ray *ray);

/*
 * Costs of ray `pixel` in units of 1 / SV_WALL_ONE, both `labels` long: `away`, the distance to the fluid,
 * and `wrong`, what it costs to cut the fetus, to leave an occluder or to stand in another fluid. False if
 * the ray was not scanned: it costs nothing.
 */
bool sv_wall_costs(const sv_wall_scan *scan, size_t pixel, sv_wall_ray *ray, uint32_t *away, uint32_t *wrong);

#endif
