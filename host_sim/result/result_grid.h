/* SPDX-License-Identifier: MIT */
/* Where the plugin's maps lie: among the voxels of the source, and in the patient. */
#ifndef HS_RESULT_GRID_H
#define HS_RESULT_GRID_H

#include "loop/maps.h"

/* The low-resolution volume's grid as a volume: pixel (i, j) of the maps is its voxel (i, j, 0), and a depth
 * of d slices is its voxel (i, j, d). So a depth in mm is d * spacing[2], measured from the map itself. */
typedef struct {
    double spacing[3]; /* mm */
    hs_pose pose;
} hs_result_grid;

/* `volume` is what the maps were made from; it says where it lies in the patient. */
void hs_result_grid_of(const hs_maps *maps, const hs_volume *volume, hs_result_grid *grid);

/* From a voxel's index to the maps: (column, row, slice) = origin + index[0] * step[0] + ... */
typedef struct {
    double origin[3], step[3][3];
} hs_result_to_map;
void hs_result_to_map_of(const hs_maps *maps, const hs_volume *volume, hs_result_to_map *to_map);

/* The depth in slices at which a ray through a place of the map begins, as the renderer has it: bilinear
 * between the pixels, clamped at the edges; 0 if nothing is clipped there. */
double hs_result_depth_at(const hs_maps *maps, double column, double row);

/* mask[i] is 1 where a voxel is kept and 0 where its centre lies before the depthmap: the camera undone. As
 * many bytes as the volume has voxels. */
void hs_result_mask(const hs_maps *maps, const hs_volume *volume, uint8_t *mask);

#endif
