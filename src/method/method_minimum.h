/* SPDX-License-Identifier: MIT */
#ifndef SV_METHOD_MINIMUM_H
#define SV_METHOD_MINIMUM_H

#include "method/method.h"

extern const sv_method sv_method_minimum;

/* The minimum filter on plane 0 of the map's points, which keeps the initial points only; the pre-filter. */
sv_status sv_minimum_prefilter(const sv_map *map, sv_method_state *state, uint32_t k, uint32_t passes);

#endif
