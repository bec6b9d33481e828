/* SPDX-License-Identifier: MIT */
/* Do no harm: what methods do where there is nothing to remove, or something that only looks like it. */
#ifndef SITE_HARM_H
#define SITE_HARM_H

#include "judge/site_table.h"

enum {
    SITE_VIEWS = 36,  /* of a volume: 12 turns about each of three axes */
    SITE_COARSE = 96, /* voxels along a side of a view; */
    SITE_FINE = 144   /* 1.8 and 1.2 mm each for a head */
};

/* View 0 .. SITE_VIEWS - 1 of a volume without a truth, a cube of `side`^3 voxels (wall_case_turn). */
bool site_view_make(const wall_case *whole, int view, uint32_t side, wall_case *out, hs_error *err);

/* Prints for every method: the variants of every case (bare, without a fetus, with a bladder), and `count`
 * volumes that nothing hides, MetaImage files, from all sides, with and without scanned ranges, behind fluid
 * and behind occluders. */
bool site_harm(const site_list *list, const char *const *volumes, uint32_t count, const site_methods *methods,
               hs_error *err);

#endif
