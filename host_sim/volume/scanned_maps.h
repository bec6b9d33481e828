/* SPDX-License-Identifier: MIT */
/* What of a volume was scanned, from two maps that a scanner wrote beside it. */
#ifndef HS_SCANNED_MAPS_H
#define HS_SCANNED_MAPS_H

#include "volume/volume.h"

/*
 * Voxel (x, y, z) was scanned if first(x, y) <= z < end(x, y): what was not becomes 0, and zeros that were
 * scanned become 1 (hs_volume). `first` and `end` are MetaImage files of nx x ny x 1 whole numbers, 0 .. nz;
 * first >= end means that nothing was scanned there.
 *
 * HS_ERR_INPUT names the file, the pixel and the value that does not fit; HS_ERR_MEMORY. The volume is then
 * unchanged.
 */
bool hs_scanned_maps_apply(hs_volume *volume, const char *first, const char *end, hs_error *err);

#endif
