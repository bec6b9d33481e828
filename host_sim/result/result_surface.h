/* SPDX-License-Identifier: MIT */
/* The clipping surface as a triangle mesh. */
#ifndef HS_RESULT_SURFACE_H
#define HS_RESULT_SURFACE_H

#include "result/result_grid.h"

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
