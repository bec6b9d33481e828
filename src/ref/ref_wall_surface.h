/* SPDX-License-Identifier: MIT */
/* From the costs of rays to a surface and its confidence. */
#ifndef REF_WALL_SURFACE_H
#define REF_WALL_SURFACE_H

#include "ref/ref_wall_rays.h"

/* Maps of width * height. False: no memory. */
bool sv_wall_select_surface(const sv_wall_scan *scan, const sv_wall_costs *costs, float *depth,
                            float *confidence);

#endif
