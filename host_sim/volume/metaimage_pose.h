/* SPDX-License-Identifier: MIT */
/* The fields of a MetaImage header that say how the volume lies. Internal to the MetaImage reader. */
#ifndef HS_METAIMAGE_POSE_H
#define HS_METAIMAGE_POSE_H

#include "volume/metaimage_text.h"
#include "volume/pose.h"

#include <stdint.h>

/*
 * TransformMatrix, Offset (each with its other names) and AnatomicalOrientation, of a header of `dims` (3 or
 * 4) dimensions. The matrix counts; without one the letters do. The pose is stated if the file names the
 * letters, or has a matrix and does not call its letters unknown ("???", which then must be the identity).
 */
bool hs_met_pose(const hs_met_text *text, uint64_t dims, hs_pose *pose);

/* UltrasoundImageOrientation: the axis that runs "far" from the probe, or "near" to it. */
bool hs_met_probe(const hs_met_text *text, hs_probe *probe);

#endif
