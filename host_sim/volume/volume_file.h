/* SPDX-License-Identifier: MIT */
/* Reads the volume of a file that holds one, whatever its format. */
#ifndef HS_VOLUME_FILE_H
#define HS_VOLUME_FILE_H

#include "volume/volume.h"

/* Reads a MetaImage file as hs_metaimage_read does, and of a Kretz file the Cartesian copy that hs_kretz_read
 * makes, without its beams; both with their default options. The caller frees `out` with hs_volume_free; on
 * failure it is zeroed. HS_ERR_INPUT, also for a sequence of several volumes, or HS_ERR_MEMORY. Any thread.
 */
bool hs_volume_file_read(const char *path, hs_volume *out, hs_error *err);

#endif
