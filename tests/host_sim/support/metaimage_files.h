/* SPDX-License-Identifier: MIT */
/* MetaImage files in a test's folder, byte by byte and without the code under test. */
#pragma once

#include "support/files.h"
#include "volume/metaimage.h"

/* A MetaImage file of these bytes: of "2 2 2" voxels of a type, or of a sequence's "2 2 2 4", with more lines
 * in its text. */
void files_volume(const char *name, const char *size, const char *type, const char *lines, const void *data,
                  size_t bytes);

/* zlib's one-call compression, kept for the test. */
uint8_t *files_deflate(const void *data, size_t bytes, size_t *compressed);

/* A file of the data, compressed by gzip. */
void files_gzip(const char *name, const void *data, unsigned bytes);

/* Reads and expects success; the volume is kept for the test. */
hs_volume files_read(const char *name, const hs_metaimage_options *opt);

/* Reads and expects HS_ERR_INPUT with the file's name and `told` (NULL for nothing more) in the message. */
void files_refused(const char *name, const char *told);
