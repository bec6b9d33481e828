/* SPDX-License-Identifier: MIT */
/* The volume in blocks of about 2 mm surroundings rays half as far apart: all that follows reads these. */
#ifndef REF_WALL_BLOCKS_H
#define REF_WALL_BLOCKS_H

#include "ref/ref_wall_volume.h"

/* Block z of ray (x, y) at means[(z * rows + y) * columns + x]: the weighted mean of its voxels, rounded half
 * up; 0 if the block was not scanned. Blocks first .. end - 1 of a ray were scanned: those all of whose
 * voxels were. `levels`: the same, smoothed along the rays where a layer is one slice; tissue is told from
 * them. */
typedef struct {
    uint32_t columns, rows, layers;
    uint8_t *means, *levels;
    uint16_t *first, *end;
    uint32_t rays; /* that were scanned */
} sv_wall_blocks;

/* False: no memory. */
bool sv_wall_blocks_create(const sv_wall_volume *volume, const sv_wall_layout *layout,
                           sv_wall_blocks *blocks);
void sv_wall_blocks_destroy(sv_wall_blocks *blocks);

/* The brightness of every cell, at [(z * cells[1] + y) * cells[0] + x]: the largest within layout->dilation
 * cells of its own, in the same layer, of half the sums of the means of a block and the one behind it,
 * rounded half up; what was not scanned counts as 0. NULL: no memory. The caller frees it. */
uint8_t *sv_wall_brightest(const sv_wall_layout *layout, const sv_wall_blocks *blocks);

#endif
