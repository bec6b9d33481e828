/* SPDX-License-Identifier: MIT */
/* The values behind a map that is lent (smartvis/band.h): every byte of them is looked at, and they are whole
 * again for the next call. */
#include "smartvis/band.h"
#include "support/unit.h"

static void every_byte_is_looked_at(void **state) {
    static uint8_t map[SV_BAND_BYTES + 2];
    uint8_t *band = map + 1;
    map[0] = map[SV_BAND_BYTES + 1] = 7;
    sv_band_make(band);
    assert_true(sv_band_holds(band));
    for (size_t i = 0; i < SV_BAND_BYTES; i++) {
        band[i] ^= (uint8_t)(1u << i % 8);
        if (sv_band_holds(band)) fail_msg("byte %zu", i);
        if (!sv_band_holds(band)) fail_msg("byte %zu is not whole again", i);
    }
    assert_true(map[0] == 7 && map[SV_BAND_BYTES + 1] == 7);
}

UNIT_MAIN(NULL, NULL, every_byte_is_looked_at)
