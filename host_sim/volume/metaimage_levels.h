/* SPDX-License-Identifier: MIT */
/* From a MetaImage file's numbers to grey levels: their range, and what becomes of them. Internal to the
 * MetaImage reader. */
#ifndef HS_METAIMAGE_LEVELS_H
#define HS_METAIMAGE_LEVELS_H

#include <stddef.h>
#include <stdint.h>

/* Widens low .. high so that it holds `count` finite numbers. */
void hs_met_widen(const double *value, size_t count, double *low, double *high);

/* low .. high becomes 0 .. 255, rounded to the nearest level; what lies beyond is clamped. low < high, and
 * hs_met_scale of them is finite. */
void hs_met_levels(const double *value, size_t count, double low, double high, uint8_t *out);

/* The level of each of `count` bit patterns of `width` bytes, 1 or 2, in this machine's order:
 * table[pattern]. */
void hs_met_look_up(const uint8_t *table, const uint8_t *raw, uint32_t width, size_t count, uint8_t *out);

/* Levels for each half of the numbers' unit. Halved, since high - low may exceed the largest double. */
double hs_met_scale(double low, double high);

#endif
