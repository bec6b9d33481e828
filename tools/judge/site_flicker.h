/* SPDX-License-Identifier: MIT */
/* How calm a surface is in a moving scene: what the renderings flicker beyond the truth's. */
#ifndef SITE_FLICKER_H
#define SITE_FLICKER_H

#include "judge/site_table.h"

/* The set of files in `list` as the frames of one sequence, or without one four scenes that move, 20 frames
 * each. Prints for every method and scene the mean over labelled rays of
 * |end in this frame - end in the one before|, slices of 128, less the same of the ground truth. A method at
 * its best q takes the one that is best for these frames. Nothing remembers unless its settings say so. */
bool site_flicker(const site_list *list, const site_methods *methods, hs_error *err);

#endif
