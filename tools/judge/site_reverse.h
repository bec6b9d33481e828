/* SPDX-License-Identifier: MIT */
/* The reverse protocol: the wall's constants chosen on one site alone, judged on the others. */
#ifndef SITE_REVERSE_H
#define SITE_REVERSE_H

#include "judge/site_set.h"

/* For every set a coordinate search over the constants that matter, at most `rounds` times over all, from all
 * at their lowest and from all at their highest value; the better of the two answers on that set counts.
 * Prints the constants and, on every set, error / cut / left and their largest ratio to the bounds. Needs two
 * sets at least. */
bool site_reverse(const site_list *list, uint32_t rounds, hs_error *err);

#endif
