/* SPDX-License-Identifier: MIT */
/* Known values behind a map that is lent to a plugin: whether it wrote more than that. As author.h does for
 * its methods. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { HS_BAND_BYTES = 4096, HS_BAND = 0xa5 }; /* more than a row of most maps */

static inline void hs_band_make(void *at) {
    memset(at, HS_BAND, HS_BAND_BYTES);
}

/* False: something was written there. It is whole again then. */
static inline bool hs_band_holds(void *at) {
    const uint8_t *band = at;
    size_t i = 0;
    while (i < HS_BAND_BYTES && band[i] == HS_BAND) i++;
    if (i < HS_BAND_BYTES) hs_band_make(at);
    return i == HS_BAND_BYTES;
}

/* What is told then: the call, the rays, and behind which map if that is not the depths'. */
#define HS_BAND_TEXT   "%s: surface wrote beyond its %u rays%s"
#define HS_BAND_STATUS " into what follows the status map"
