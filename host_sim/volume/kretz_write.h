/* SPDX-License-Identifier: MIT */
/* Writes volumes in probe geometry as KRETZFILE 1.0 (.vol): for tests and for scenes. */
#ifndef HS_KRETZ_WRITE_H
#define HS_KRETZ_WRITE_H

#include "base/output_file.h"
#include "volume/beams.h"

/* A file under way. Zeroed: nothing is open. */
typedef struct {
    hs_output_file out;
    size_t bytes;  /* of a volume */
    uint32_t left; /* volumes that are still to come */
} hs_kretz_writer;

/*
 * Begins a file of `count` volumes, more than one of them as a sequence, in the geometry of `beams`, whose
 * voxels and mirror are not read. Tables are written as they stand, with pi / 2 added, as scanners do. It has
 * no text and names nobody. HS_ERR_OUTPUT names the path and what cannot be written: no volume, or more than
 * 4 GB of them.
 */
bool hs_kretz_write_open(hs_kretz_writer *writer, const char *path, const hs_beams *beams, uint32_t count,
                         hs_error *err);

/* The next volume: as many bytes as `beams` has samples. */
bool hs_kretz_write_volume(hs_kretz_writer *writer, const uint8_t *voxels, hs_error *err);

/* Ends the file when all volumes are written: it appears under its name then. Either way the struct is
 * zeroed. */
bool hs_kretz_write_commit(hs_kretz_writer *writer, hs_error *err);

/* Gives the file up; nothing is left behind. Safe on a zeroed struct. */
void hs_kretz_write_discard(hs_kretz_writer *writer);

#endif
