/* SPDX-License-Identifier: MIT */
/* What a file may leave out, as options of every command that opens files: --spacing and --probe. */
#pragma once

#include "core/options.h"
#include "loop/sequence.h"

/* "-z", "+z", ..., into an hs_metaimage_options. HS_ERR_USAGE. */
bool hs_source_take_probe(void *read, const char *text, hs_error *err);

/* "X,Y,Z" in mm, 1e-6 .. 1e6, into an hs_metaimage_options. HS_ERR_USAGE. */
bool hs_source_take_spacing(void *read, const char *text, hs_error *err);

#define HS_SOURCE_SPACING_HELP                                                                               \
    "mm between the voxels of a MetaImage that does not say it, or wrongly [FILE's]"

/* The same, or one number, into an hs_source_files: how far apart the voxels of a Kretz file's copy are. */
bool hs_source_take_either_spacing(void *files, const char *text, hs_error *err);

#define HS_SOURCE_SPACING_ROW(at)                                                                            \
    HS_TAKEN("spacing", "X,Y,Z", at, hs_source_take_either_spacing,                                          \
             HS_SOURCE_SPACING_HELP                                                                          \
             "\nMM, of a Kretz file: voxels of its Cartesian copy [pitch, or 1/400 of its side]")

/* The rows of both, for an hs_metaimage_options at offset `at`. */
#define HS_SOURCE_PROBE_ROW(at)                                                                              \
    HS_TAKEN("probe", "FACE", at, hs_source_take_probe,                                                      \
             "where the probe is: -z (slice 0), +z, -y, +y, -x or +x; as FILE says, or -z [FILE's]")
#define HS_SOURCE_ROWS(at)                                                                                   \
    HS_TAKEN("spacing", "X,Y,Z", at, hs_source_take_spacing, HS_SOURCE_SPACING_HELP), HS_SOURCE_PROBE_ROW(at)
