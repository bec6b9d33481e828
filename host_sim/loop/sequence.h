/* SPDX-License-Identifier: MIT */
/* Files, one after the other, as one sequence of volumes. At most one of them is open at a time, and no
 * volume is kept. */
#pragma once

#include "volume/kretz.h"

/* How files are read: MetaImage and Kretz. Zeros are the defaults. */
typedef struct {
    hs_metaimage_options metaimage;
    hs_kretz_options kretz; /* its padding and folder are not read: metaimage's hold for both */
} hs_source_files;

/* Where a volume was read from. */
typedef struct {
    const char *path;       /* borrowed from who opened the sequence */
    bool metaimage;         /* a MetaImage file, whose voxels lie as the volume's do */
    uint32_t index;         /* among the file's valid volumes */
    hs_frame_fields fields; /* what the file says about it */
} hs_source_origin;

typedef struct hs_sequence hs_sequence;

/* Opens every file in turn and checks what it says; `paths` must outlive it, `how` need not. HS_ERR_INPUT if
 * one differs from the first in size, spacing, orientation or the probe's geometry: the message names both.
 * HS_ERR_USAGE for a window, maps or a probe for a Kretz file. Else the errors of hs_metaimage_open and
 * hs_kretz_open, or HS_ERR_MEMORY. NULL on failure. */
hs_sequence *hs_sequence_open(const char *const *paths, uint32_t count, const hs_source_files *how,
                              hs_error *err);
void hs_sequence_close(hs_sequence *sequence); /* NULL is allowed */

/* Volumes of all files, and those that the files themselves call invalid, which are left out. */
uint32_t hs_sequence_count(const hs_sequence *sequence);
uint32_t hs_sequence_left_out(const hs_sequence *sequence);

/* Where the volumes came from; it belongs to the sequence. */
const hs_source_origin *hs_sequence_origins(const hs_sequence *sequence);

/* Reads volume `index` (0 .. count - 1), with its file's name and place. A zeroed `volume` is made, one that
 * an earlier call made is filled again. A file that is not open is opened anew: HS_ERR_INPUT if it changed
 * since _open. Else the errors of hs_kretz_read and hs_metaimage_read_at. One thread at a time. */
bool hs_sequence_read(hs_sequence *sequence, uint32_t index, hs_volume *volume, hs_error *err);

/* How the values of the file that is open became levels; NULL: of Kretz, or if none is open. */
const hs_levels *hs_sequence_levels(const hs_sequence *sequence);

/* Closes the file that is open, until the next _read. */
void hs_sequence_stop_reading(hs_sequence *sequence);
