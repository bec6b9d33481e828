/* SPDX-License-Identifier: MIT */
/* The minimum filter (thesis 3.3, Algorithm 4.4). */
#pragma once

#include "ref/ref_method.h"

/* The pre-filter: `passes` passes, then initial points only. `filtered` holds their new depths. */
bool sv_ref_minimum_prefilter(const sv_ref_map *map, uint32_t k, uint32_t passes, double *filtered);
