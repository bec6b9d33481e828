/* SPDX-License-Identifier: MIT */
/* A scene as files: MetaImage volumes and maps, or what a probe would have scanned as Kretz files (.vol). */
#pragma once

#include "scene/scene.h"
#include "volume/kretz.h"

/* Writes <prefix>_full.mha, _truth.mha, _label.mha, _near.mha and _far.mha: volumes, and maps of one
 * slice. Where the label is 0, near and far hold -1 in the files. HS_ERR_OUTPUT or HS_ERR_MEMORY. */
bool hs_scene_export(const hs_scene_data *data, const char *prefix, hs_error *err);

/* Files under way. Zeroed: none. */
typedef struct {
    hs_kretz_writer full, truth;
    hs_beams *beams;
} hs_vol_export;

/* Writes one of `frames` frames of a scene, in their order, to <prefix>_full.vol and <prefix>_truth.vol, in a
 * fan that lies in the volume: the first one opens them, the last one ends them. A scene of one frame gets
 * its <prefix>_label.mha, too: on the columns of the Cartesian copy, the scene's label where the column's
 * middle stands, and 0 where the end of its interval was not scanned. On failure nothing is left behind, and
 * the struct is zeroed: HS_ERR_USAGE, HS_ERR_OUTPUT or HS_ERR_MEMORY. */
bool hs_vol_export_frame(hs_vol_export *out, const char *prefix, uint32_t frames, const hs_scene_data *data,
                         hs_error *err);

/* Gives files under way up. Safe on a zeroed struct. */
void hs_vol_export_discard(hs_vol_export *out);
