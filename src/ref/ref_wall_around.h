/* SPDX-License-Identifier: MIT */
/*
 * What is around tissue in its layer tells what it is: tissue that the wall encloses lies behind fluid, and
 * is wall all the same, as behind a bladder; what is beside the fetus may be the fetus that lies against the
 * wall.
 *
 * A cell is tissue, wall, or other tissue, if at least SV_WALL_MOST_RAYS of its rays are; a ray is wall in
 * its first tissue, where that touches the start of the scan, and other tissue elsewhere. Maps have a byte
 * for every layer and cell, as `scan->bright` lies; allocated; NULL: no memory.
 */
#ifndef REF_WALL_AROUND_H
#define REF_WALL_AROUND_H

#include "ref/ref_wall_evidence.h"

/* 1 where the wall encloses tissue: from there one comes to the wall through tissue alone to the left, to the
 * right, upwards and downwards; else 0. Needs no brightness. */
uint8_t *sv_wall_enclosed(const sv_wall_scan *scan);

/* What is beside the fetus: SV_WALL_FLANKED where one comes to it through tissue alone to the left and to the
 * right, or upwards and downwards; SV_WALL_ONE_SIDE where one comes to it on one side; else 0. The fetus:
 * cells of other tissue that are not enclosed, and that are the fetus with a probability of `flank` at least.
 */
uint8_t *sv_wall_beside(const sv_wall_scan *scan, const sv_wall_evidence *evidence);

#endif
