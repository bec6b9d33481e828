/* SPDX-License-Identifier: MIT */
/* Method wall beside its definition: one frame of a volume, in both layouts of the work, at several positions
 * of the knob. */
#pragma once

#include "ref/ref_wall.h"
#include "support/rig.h"

typedef struct {
    uint32_t width, height, slices, slab_slices;
    int32_t padding;
    float spacing_mm[3]; /* zeros: unknown */
    const sv_scanned *scanned;
    const sv_beams *beams; /* NULL: not told */
} wall_shape;

/* Compares both layouts, and a doubtful surface with and without clipping there. Returns true if there is a
 * surface; `unasked`: the outcome without clipping there. */
bool wall_compare_outcome(rig *r, const wall_shape *s, const uint8_t *volume, const char *what,
                          sv_wall_outcome *unasked);
bool wall_compare(rig *r, const wall_shape *s, const uint8_t *volume, const char *what);

/* Tissue, fluid and bone in layers of up to `longest` slices, the same for patches of rays but for their
 * ends: thin tissue, narrow fluid, rays that begin in fluid. */
uint8_t *wall_layered_noise(uint32_t width, uint32_t height, uint32_t slices, uint32_t longest,
                            uint32_t patch_side, uint32_t seed);
