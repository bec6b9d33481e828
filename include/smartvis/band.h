/* SPDX-License-Identifier: MIT */
/*
 * A helper for plugins and hosts, header-only and optional: known values behind a map that is lent to
 * somebody, and whether more than the map was written. author.h, hosts and the checking layer use it.
 */
#ifndef SMARTVIS_BAND_H
#define SMARTVIS_BAND_H

#include "smartvis_plugin.h"

#include <string.h>

SMARTVIS_BEGIN_C

/* Bytes of the value behind a map: more than a row of most of them. */
enum { SV_BAND_BYTES = 4096, SV_BAND = 0xa5 };

/* What is told then: the call, the rays, and behind which map, or "". */
#define SV_BAND_TEXT   "%s: surface wrote beyond its %u rays%s"
#define SV_BAND_STATUS " into what follows the status map"

static inline void sv_band_make(void *band) {
    memset(band, SV_BAND, SV_BAND_BYTES);
}

/* 0: something was written there. The band is whole again then. */
static inline int sv_band_holds(void *band) {
    const uint8_t *at = (const uint8_t *)band;
    size_t i = 0;
    while (i < SV_BAND_BYTES && at[i] == SV_BAND) i++;
    if (i < SV_BAND_BYTES) sv_band_make(band);
    return i == SV_BAND_BYTES;
}

SMARTVIS_END_C

#endif
