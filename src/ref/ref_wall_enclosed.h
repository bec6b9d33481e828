/* SPDX-License-Identifier: MIT */
/* Tissue that the wall encloses: it lies behind fluid, and is wall all the same, as behind a bladder. */
#ifndef REF_WALL_ENCLOSED_H
#define REF_WALL_ENCLOSED_H

#include "ref/ref_wall_evidence.h"

/* For every layer and cell, as `scan->bright` lies: 1 if the wall encloses it, else 0. A cell is tissue, or
 * wall, if at least SV_WALL_MOST_RAYS of its rays are; a ray is wall in its first tissue, where that touches
 * the start of the scan. Enclosed is tissue from which one comes to the wall through tissue alone to the
 * left, to the right, upwards and downwards, within its layer. Allocated; NULL: no memory. Needs no
 * brightness. */
uint8_t *sv_wall_enclosed(const sv_wall_scan *scan);

#endif
