/* SPDX-License-Identifier: MIT */
/* A contact sheet of a scene: everything one has to look at to judge it. */
#ifndef HS_SCENE_SHEET_H
#define HS_SCENE_SHEET_H

#include "picture/picture.h"
#include "render/host_cl.h"
#include "scene/scene.h"

/* Four columns: DVR of the full volume, DVR of the ground truth, MIP, label map; three slices with the
 * admissible interval drawn in (near end blue, far end orange), its width; histogram, and the facts.
 * The caller frees *out. HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool hs_scene_sheet(const hs_cl *cl, const hs_scene_data *data, const char *title, hs_picture *out,
                    hs_error *err);

#endif
