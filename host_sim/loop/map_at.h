/* SPDX-License-Identifier: MIT */
/* A map between its pixels. */
#pragma once

#include <stdint.h>

/* At a place between its pixels, as the renderer has it: bilinear, clamped at the edges. */
double hs_map_at(const float *map, uint32_t width, uint32_t height, double column, double row);
