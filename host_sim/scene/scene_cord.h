/* SPDX-License-Identifier: MIT */
/* The umbilical cord as solids: three vessels wound round a curve. */
#ifndef HS_SCENE_CORD_H
#define HS_SCENE_CORD_H

#include "scene/scene_solid.h"
#include "scene/scene_spec.h"

/* Along the points of the cord. */
void hs_scene_cord(hs_solid_list *list, const hs_cord_spec *cord);

/* Round the neck of a fetus: the rings lie slack_mm off the skin, but no farther than the chin. False
 * without memory. */
bool hs_scene_nuchal_cord(hs_solid_list *list, const hs_nuchal_spec *cord, const hs_fetus_spec *fetus);

#endif
