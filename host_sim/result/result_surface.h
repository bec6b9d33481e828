/* SPDX-License-Identifier: MIT */
/* Where the maps lie among the voxels of the source and in the patient, and the clipping surface as a
 * triangle mesh. */
#ifndef HS_RESULT_SURFACE_H
#define HS_RESULT_SURFACE_H

#include "loop/view.h"

/* The low-resolution volume's grid as a volume: pixel (i, j) of the maps is its voxel (i, j, 0), and a depth
 * of d slices is its voxel (i, j, d). So a depth in mm is d * spacing[2], measured from the map itself. */
typedef struct {
    double spacing[3]; /* mm */
    hs_pose pose;
} hs_result_grid;

/* `volume` is what the maps were made from; it says where it lies in the patient. */
void hs_result_grid_of(const hs_maps *maps, const hs_volume *volume, hs_result_grid *grid);

/* mask[i] is 1 where a voxel is kept and 0 where its centre lies before the depthmap: the camera undone. As
 * many bytes as the volume has voxels. */
void hs_result_mask(const hs_maps *maps, const hs_volume *volume, uint8_t *mask);

#define HS_SURFACE_STEEPEST 4.0 /* mm of depth per mm across; a steeper cell is a step, and cut */

/* What became of a depthmap. */
typedef struct {
    uint32_t vertices, triangles;
} hs_surface_size;

/*
 * Writes a PLY file (binary): a vertex in mm of the patient (hs_pose) for every pixel whose surface lies in
 * the volume, and two triangles for every cell of four of them whose depths differ by no more than
 * HS_SURFACE_STEEPEST allows. Their front is towards the camera. Vertices without a triangle are left out.
 * HS_ERR_OUTPUT names the path; HS_ERR_MEMORY.
 */
bool hs_result_write_surface(const char *path, const hs_maps *maps, const hs_volume *volume,
                             hs_surface_size *size, hs_error *err);

#endif
