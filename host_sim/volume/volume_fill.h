/* SPDX-License-Identifier: MIT */
/* Fills a volume's voxels on several threads, and gives its zeros their meaning: not scanned. */
#ifndef HS_VOLUME_FILL_H
#define HS_VOLUME_FILL_H

#include "volume/volume.h"

/* Fills `count` voxels from voxel `first` on, whole rows of them, into `out`. */
typedef bool (*hs_fill_fn)(void *context, size_t first, size_t count, uint8_t *out, hs_error *err);

/* Fills all voxels piece by piece, on up to `threads` threads; with one of them in order. False with what
 * `fill` said about the first piece that failed. */
bool hs_volume_fill(hs_volume *volume, uint32_t threads, hs_fill_fn fill, void *context, hs_error *err);

/* The same, and what hs_volume_mark_unscanned does, while the voxels are still in the cache: a pass over
 * memory less. */
bool hs_volume_fill_marked(hs_volume *volume, uint32_t threads, hs_fill_fn fill, void *context,
                           hs_error *err);

/* Keeps as 0 only the zeros that are connected (6-neighbourhood) to the volume's border through zeros, and
 * raises every other zero to 1. Needs a quarter of the volume's size for a while; false (HS_ERR_MEMORY,
 * volume unchanged) if that runs out. */
bool hs_volume_mark_unscanned(hs_volume *volume, hs_error *err);

/* Raises every zero to 1. */
void hs_raise_zeros(uint8_t *voxels, size_t count);

/* The same: all of the volume was scanned. */
void hs_volume_mark_all_scanned(hs_volume *volume);

#endif
