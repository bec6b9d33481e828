/* SPDX-License-Identifier: MIT */
/* Random scenes by seed and number. */
#ifndef HS_SCENE_DRAW_H
#define HS_SCENE_DRAW_H

#include <stdbool.h>
#include <stdint.h>

#define HS_SCENE_MAX_DRAWN 100000u /* numbers of a set are below */

/* Reads "R<seed>_<number>": the name of a random scene. */
bool hs_scene_drawn_name(const char *name, uint64_t *seed, uint32_t *number);

/* The file of scene `number` of the set `seed`, drawn from hs_scene_ranges with whole numbers only: the
 * same text on every machine. free() it; NULL without memory. */
char *hs_scene_draw(uint64_t seed, uint32_t number);

#endif
