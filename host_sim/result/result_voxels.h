/* SPDX-License-Identifier: MIT */
/* The source's voxels as its MetaImage files hold them, in their own type; those of scenes and Kretz files,
 * which hold beams, from memory. */
#ifndef HS_RESULT_VOXELS_H
#define HS_RESULT_VOXELS_H

#include "loop/source.h"
#include "volume/metaimage.h"

typedef struct hs_result_voxels hs_result_voxels;

/* Files are read through once for their smallest value, unless they hold MET_UCHAR. HS_ERR_INPUT if they
 * cannot be read any more, or are not of one type; HS_ERR_MEMORY. NULL on failure. `err` must outlive it. */
hs_result_voxels *hs_result_voxels_open(const hs_source *source, hs_error *err);
void hs_result_voxels_close(hs_result_voxels *voxels); /* NULL is allowed */

/* What each voxel is, and what stands for one that was cut away: 0 in MET_UCHAR, else the smallest value of
 * all volumes, so that what is black stays black. */
hs_met_type hs_result_voxels_type(const hs_result_voxels *voxels);
const uint8_t *hs_result_voxels_fill(const hs_result_voxels *voxels);
double hs_result_voxels_fill_value(const hs_result_voxels *voxels);

/* Turns to volume `index` of the source: 0 first, then one after the other. */
bool hs_result_voxels_turn(hs_result_voxels *voxels, uint32_t index);

enum { HS_RESULT_CHUNK = 8192 }; /* voxels that are handed on at once, at most */

/* The volume's next `count` voxels, at most HS_RESULT_CHUNK, in this machine's byte order; good until the
 * next call. NULL on failure. */
const uint8_t *hs_result_voxels_next(hs_result_voxels *voxels, size_t count);

#endif
