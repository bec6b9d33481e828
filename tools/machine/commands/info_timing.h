/* SPDX-License-Identifier: MIT */
/* How long reading a volume takes, beside reading its bytes alone; and sampling it, if it is a probe's. */
#ifndef HS_INFO_TIMING_H
#define HS_INFO_TIMING_H

#include "volume/kretz.h"

/* Reads the file's first volume several times, as bytes and as a volume, each time into new memory, and
 * prints the shortest times and their ratio. Compressed bytes are inflated by zlib, too, and nothing more. If
 * the volume is in probe geometry, hs_info_sampling follows. HS_ERR_INPUT, HS_ERR_USAGE, HS_ERR_DEVICE or
 * HS_ERR_MEMORY. */
bool hs_info_timing(const char *path, const hs_kretz_options *kretz, hs_error *err);

#endif
