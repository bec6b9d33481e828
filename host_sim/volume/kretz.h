/* SPDX-License-Identifier: MIT */
/* Reads and writes GE Kretz volumes (.vol): single ones and sequences, in probe geometry or Cartesian. Reads
 * them out of DICOM files, too. docs/kretz.md. */
#pragma once

#include "core/output_file.h"
#include "volume/metaimage.h"

typedef struct {
    bool mirrored;      /* positive sweep angles lie at +y; else at -y (hs_beams) */
    double spacing;     /* mm: voxels of the Cartesian copy; 0: as hs_beams_cartesian_init chooses */
    hs_padding padding; /* of a Cartesian file; one in probe geometry says itself what was scanned */
    const char *folder; /* the file lies in it or below, wherever links lead; NULL: anywhere */
} hs_kretz_options;

typedef struct hs_kretz hs_kretz;

/* True if the name ends in .vol or .v00 .. .v05. */
bool hs_kretz_is_name(const char *name);

/* The same, or the file begins as a KRETZFILE or a DICOM file does: read it here. */
bool hs_kretz_is_file(const char *path);

/*
 * Opens a file and checks all it says, but reads no voxel; `options` may be NULL for zeros. NULL on failure:
 * HS_ERR_INPUT names file, item and value, HS_ERR_USAGE the spacing. Personal data in the file is neither
 * read nor named. One thread at a time may use it.
 */
hs_kretz *hs_kretz_open(const char *path, const hs_kretz_options *options, hs_error *err);
void hs_kretz_close(hs_kretz *kretz);

/* Volumes in the file, >= 1. */
uint32_t hs_kretz_count(const hs_kretz *kretz);

/* Size, spacing, geometry and name of its volumes; no voxels. Free it with hs_volume_free. HS_ERR_USAGE (the
 * spacing) or HS_ERR_MEMORY. */
bool hs_kretz_shape(const hs_kretz *kretz, hs_volume *shape, hs_error *err);

/*
 * Reads volume `index` (0 .. count - 1). A zeroed `volume` is made, and the caller frees it with
 * hs_volume_free; one that an earlier call made from the same file is filled again, without new memory. In
 * probe geometry the bytes go from the file straight to volume->beams, and the Cartesian copy is made from
 * there; in a Cartesian file they go straight to the voxels. HS_ERR_INPUT, HS_ERR_USAGE (the spacing) or
 * HS_ERR_MEMORY; a volume that was to be made is zeroed then.
 */
bool hs_kretz_read(const hs_kretz *kretz, uint32_t index, hs_volume *volume, hs_error *err);

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

/* Reads a MetaImage file as hs_metaimage_read does, and of a Kretz file the Cartesian copy that hs_kretz_read
 * makes, without its beams; both with their default options. The caller frees `out` with hs_volume_free; on
 * failure it is zeroed. HS_ERR_INPUT, also for a sequence of several volumes, or HS_ERR_MEMORY. Any thread.
 */
bool hs_volume_file_read(const char *path, hs_volume *out, hs_error *err);
