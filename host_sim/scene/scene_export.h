/* SPDX-License-Identifier: MIT */
/* A scene's volumes and maps as MetaImage files. */
#ifndef HS_SCENE_EXPORT_H
#define HS_SCENE_EXPORT_H

#include "scene/scene_data.h"

/* Writes <prefix>_full.mha, _truth.mha, _label.mha, _near.mha and _far.mha: volumes, and
 * maps of one slice. Where the label is 0, near and
 * far hold -1 in the files. HS_ERR_OUTPUT or HS_ERR_MEMORY. */
bool hs_scene_export(const hs_scene_data *data, const char *prefix, hs_error *err);

#endif
