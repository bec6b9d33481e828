/* SPDX-License-Identifier: MIT */
/* An open file that holds volumes, whatever its format: any of them can be read at any time. */
#ifndef HS_SEQUENCE_FILE_H
#define HS_SEQUENCE_FILE_H

#include "volume/kretz.h"

/* The maps that a scanner wrote beside a volume: every ray's first scanned slice, and the first one behind
 * the scan. */
typedef struct {
    const char *first, *end; /* MetaImage files; NULL: there are none, and the reading options tell */
} hs_source_scanned;

/* How files are read: MetaImage, with maps that hold for all of them, and Kretz. Zeros are the defaults. */
typedef struct {
    hs_metaimage_options metaimage;
    hs_source_scanned scanned;
    hs_kretz_options kretz; /* its padding is not read: metaimage.padding holds for both */
} hs_source_files;

/* One of the two is open, or none. Owned. */
typedef struct {
    hs_kretz *kretz;
    hs_metaimage *metaimage;
    hs_source_scanned scanned; /* for every volume of `metaimage` */
} hs_sequence_file;

/* Opens a MetaImage (.mha, .mhd) or Kretz file (.vol); `path` must outlive it. On failure nothing is open:
 * HS_ERR_INPUT if it cannot be read, HS_ERR_USAGE for a window, maps or a probe for a Kretz file, and the
 * errors of hs_metaimage_open and hs_kretz_open. */
bool hs_sequence_file_open(hs_sequence_file *file, const char *path, const hs_source_files *how,
                           hs_error *err);

/* Volumes in it, without those that are invalid. */
uint32_t hs_sequence_file_count(const hs_sequence_file *file);

/* What hs_metaimage_shape and hs_kretz_shape say. Free it with hs_volume_free. */
bool hs_sequence_file_shape(const hs_sequence_file *file, hs_volume *shape, hs_error *err);

/* Reads volume `index` (0 .. count - 1). A zeroed `volume` is made, one that an earlier call made of a file
 * of the same shape is filled again; the errors are those of hs_kretz_read, or of hs_metaimage_read_at and
 * hs_scanned_maps_apply, and after them a volume that was to be made is zeroed. One thread at a time. */
bool hs_sequence_file_read(hs_sequence_file *file, uint32_t index, hs_volume *volume, hs_error *err);

/* Safe if none is open. */
void hs_sequence_file_close(hs_sequence_file *file);

#endif
