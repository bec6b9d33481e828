/* SPDX-License-Identifier: MIT */
/* What a file may leave out, as options of every command that opens files: --spacing and --probe. */
#ifndef HS_SOURCE_OPTIONS_H
#define HS_SOURCE_OPTIONS_H

#include "base/options.h"
#include "volume/metaimage.h"

/* "-z", "+z", ..., into an hs_metaimage_options. HS_ERR_USAGE. */
bool hs_source_take_probe(void *read, const char *text, hs_error *err);

/* "X,Y,Z" in mm, 1e-6 .. 1e6, into an hs_metaimage_options. HS_ERR_USAGE. */
bool hs_source_take_spacing(void *read, const char *text, hs_error *err);

#define HS_SOURCE_PROBE_HELP                                                                                 \
    "where the probe is: -z (slice 0), +z, -y, +y, -x or +x; as FILE says, or -z [FILE's]\n"
#define HS_SOURCE_SPACING_HELP                                                                               \
    "mm between the voxels of a MetaImage that does not say it, or wrongly [FILE's]\n"

/* The rows of both, for an hs_metaimage_options at offset `at`. */
#define HS_SOURCE_ROWS(at)                                                                                   \
    {"spacing", "X,Y,Z", HS_SOURCE_SPACING_HELP, HS_OPTION_TAKEN, at, 0, 0, hs_source_take_spacing}, {       \
        "probe", "FACE", HS_SOURCE_PROBE_HELP, HS_OPTION_TAKEN, at, 0, 0, hs_source_take_probe               \
    }

#endif
