/* SPDX-License-Identifier: MIT */
/* A scene's own clipping surface as a depthmap, so that its ground truth can be drawn as a result is. */
#ifndef HS_TRUTH_SURFACE_H
#define HS_TRUTH_SURFACE_H

#include "render/dvr.h"
#include "scene/scene.h"

/*
 * The surface in a box as wide and deep as the camera's: as many pixels across as the wider side of the scene
 * has voxels, and its nz slices. A pixel beside the scene is 0 and clips nothing. The buffer is a new one,
 * which the caller releases. The camera must look from the probe (hs_truth_surface_fits): the surface is
 * known there only. HS_ERR_MEMORY or HS_ERR_DEVICE.
 */
bool hs_truth_surface(const hs_cl *cl, const hs_scene_data *data, const hs_camera *camera,
                      hs_start_depths *out, hs_error *err);

/* True if the camera looks along the scene's own rays. */
bool hs_truth_surface_fits(const hs_camera *camera);

#endif
