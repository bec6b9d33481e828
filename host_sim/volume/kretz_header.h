/* SPDX-License-Identifier: MIT */
/* What a KRETZFILE says of its grey volume, checked. Internal to the Kretz reader. */
#ifndef HS_KRETZ_HEADER_H
#define HS_KRETZ_HEADER_H

#include "volume/beams.h"
#include "volume/kretz_items.h"

#define HS_KRETZ_MIN_PITCH  0.01   /* mm between samples, or a voxel's edge */
#define HS_KRETZ_MAX_PITCH  5.0    /* mm */
#define HS_KRETZ_MIN_SPAN   0.01   /* rad: of a narrower fan the copy would be one voxel wide */
#define HS_KRETZ_MAX_OFFSET 1000.0 /* mm: start of the samples, and place of the sweep's axis */
#define HS_KRETZ_TIMES      65536u /* volumes of a sequence */

typedef struct {
    bool cartesian;
    uint32_t size[3]; /* samples, lines, planes; or voxels along x, y, z. Each 1 (beams: 2) .. 2048 */
    double spacing;   /* mm: a Cartesian voxel's edge */
    hs_beams beams;   /* else: the geometry, with tables but without voxels; not mirrored */
    uint64_t voxels;  /* where those of the first volume begin; the others follow without a gap */
    uint32_t count;   /* volumes, >= 1 */
} hs_kretz_header;

/*
 * Walks all items and checks what they say. Everything is checked in 64 bits before anything is allocated.
 * HS_ERR_INPUT names the file, the item and its value; HS_ERR_MEMORY. Texts, which are personal data, and
 * unknown items are skipped by their length and never read. On failure the header is zeroed.
 */
bool hs_kretz_header_read(hs_kretz_items *items, hs_kretz_header *header, hs_error *err);

/* Frees the tables. Safe on a zeroed struct. */
void hs_kretz_header_free(hs_kretz_header *header);

#endif
