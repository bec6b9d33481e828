/* SPDX-License-Identifier: MIT */
/* An open file that holds a sequence, whatever its format: any of its volumes can be read at any time. */
#ifndef HS_SEQUENCE_FILE_H
#define HS_SEQUENCE_FILE_H

#include "volume/kretz.h"

/* The maps that a scanner wrote beside a volume: every ray's first scanned slice, and the first one behind
 * the scan. */
typedef struct {
    const char *first, *end; /* MetaImage files; NULL: there are none, and the reading options tell */
} hs_source_scanned;

/* One of the two is open. Owned. */
typedef struct {
    hs_kretz *kretz;
    hs_metaimage *metaimage;
    hs_source_scanned scanned; /* for every volume of `metaimage` */
} hs_sequence_file;

/* Volumes in it, without those that are invalid. */
uint32_t hs_sequence_file_count(const hs_sequence_file *file);

/* Reads volume `index` (0 .. count - 1). A zeroed `volume` is made, one that an earlier call made is filled
 * again; the errors are those of hs_kretz_read, or of hs_metaimage_read_at and hs_scanned_maps_apply, and
 * after them a volume that was to be made is zeroed. One thread at a time. */
bool hs_sequence_file_read(hs_sequence_file *file, uint32_t index, hs_volume *volume, hs_error *err);

void hs_sequence_file_close(hs_sequence_file *file);

#endif
