/* SPDX-License-Identifier: MIT */
/* Scans as six probes make them, and the same as files have them: a part, along other axes. */
#pragma once

#include "volume/volume.h"

typedef struct {
    double start, depth, axis, theta, phi; /* mm; rad, half of what they span */
    double spacing;                        /* mm */
    double from[3], to[3];                 /* the part of the volume that the file has */
} fan_shape;

/* Abdominal probes of three makes, one with its axis behind the array; a file that ends within the fan on
 * three sides; an endocavity probe; coarse voxels. */
enum { FANS = 6 };
extern const fan_shape fan_shapes[FANS];

/* The Cartesian copy of such a scan, all of one level; hs_volume_free it, as all volumes here. */
hs_volume fan_copy(const fan_shape *g);

/* The volume as a file has it whose face `face` is the probe's: a part of it, along other axes. `apex` is mm
 * from its corner. */
hs_volume fan_seen_from(const hs_volume *v, const fan_shape *g, hs_probe face, double apex[3]);
