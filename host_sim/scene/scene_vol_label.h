/* SPDX-License-Identifier: MIT */
/* The label map of a scene that was written as a Kretz file, on the columns of the Cartesian copy of it. */
#ifndef HS_SCENE_VOL_LABEL_H
#define HS_SCENE_VOL_LABEL_H

#include "scene/scene_data.h"
#include "volume/beams.h"

/* Writes <prefix>_label.mha, of as many columns as the copy has that hs_kretz_read makes by default, in one
 * slice: the scene's label where the column's middle stands, and 0 where the end of its interval was not
 * scanned. `beams` are those that hs_vol_fill fills. HS_ERR_USAGE (the copy), HS_ERR_OUTPUT or HS_ERR_MEMORY.
 */
bool hs_vol_label_write(const char *prefix, hs_beams *beams, const hs_scene_data *data, hs_error *err);

#endif
