/* SPDX-License-Identifier: MIT */
/*
 * What is surroundings tissue in its layer tells what it is: tissue that the wall encloses lies behind fluid,
 * and is wall all the same, as behind a bladder; what is beside the fetus may be the fetus that lies against
 * the wall.
 *
 * A cell is tissue, wall, or other tissue, if at least SV_WALL_MAJORITY of its rays are; a ray is wall in
 * its first tissue, where that touches the start of the scan, and other tissue elsewhere. The fetus: cells of
 * other tissue that are not enclosed, and that are the fetus with a probability of `flank` at least.
 */
#ifndef REF_WALL_SURROUNDINGS_H
#define REF_WALL_SURROUNDINGS_H

#include "ref/ref_wall_evidence.h"

/* What is surroundings every cell of every layer (SV_WALL_ENCLOSED and so on), as `scan->bright` lies;
 * allocated; NULL: no memory. `scan->surroundings` is not read. */
uint8_t *sv_wall_find_surroundings(const sv_wall_scan *scan, const sv_wall_evidence *evidence);

#endif
