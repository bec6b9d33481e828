/* SPDX-License-Identifier: MIT */
/*
 * The clipping surface told by the wall: tissue in front of the fluid on most rays is the wall, and tissue
 * brighter than the wall is the fetus. docs/surface.md has the definition in words. Nothing here needs
 * OpenCL, and nothing is fast. All but the evidence tables, the mean of the layers, the interpolation and the
 * confidence is integer arithmetic, so kernels can follow it bit for bit.
 */
#pragma once

#include "ref/ref_method.h"
#include "wall_layout.h"

/* What was found on the way. */
typedef struct {
    uint32_t threshold;  /* largest grey level of the dark class */
    double gap_share;    /* of the dark blocks, the share in the gaps that the surface lies in */
    uint32_t share;      /* the same, of 1000 */
    uint32_t rays;       /* scanned rays of blocks */
    uint32_t wall_rays;  /* of these, rays that begin in tissue and have fluid behind it */
    double wall, spread; /* brightness of the wall, grey levels; its spread, ln of the odds */
    double fetus;        /* mean probability over the rays that the fetus is on them */
    double wanted;       /* the limit of `fetus` if no fetus is seen, else of `gap_share` */
} sv_wall_facts;

/* True if sizes, spacing and ranges are as stated above; else the text names field and value. */
bool sv_wall_check(const sv_wall_volume *volume, char *text, size_t size);

/*
 * Finds the surface. `depth` gets width * height slices: 0 is the centre of slice 0, and clips nothing.
 * `confidence` gets as many numbers 0 .. 1: how likely the surface is right within two slices of 128.
 * `settings` NULL: the default ones. `facts` may be NULL. False if memory runs out or sv_wall_check fails;
 * the maps are then as they were. Any thread may call it.
 */
bool sv_wall_surface(const sv_wall_volume *volume, const sv_wall_settings *settings, float *depth,
                     float *confidence, sv_wall_outcome *outcome, sv_wall_facts *facts);

/* Finds the surface of a volume that may have a padding value. Voxels of that value were not scanned. A ray
 * then goes from its first other voxel to its last, and the padding between them counts as 0.
 * Any spacing is taken: one out of range counts as the nearest that is not. `beams` may be NULL. */
bool sv_wall_surface_padded(const sv_ref_volume *volume, const double spacing_mm[3], const sv_beams *beams,
                            const sv_wall_settings *settings, float *depth, float *confidence,
                            sv_wall_outcome *outcome, sv_wall_facts *facts);
