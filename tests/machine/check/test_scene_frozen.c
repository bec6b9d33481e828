/* SPDX-License-Identifier: MIT */
/* The nine cases of the thesis stay as they are, bit for bit: what was measured on them once can be
 * compared with. The sums were taken from the scenes as they stood when the hard cases were added. */
#include "support/scene_fixture.h"

#include <zlib.h>

enum { SIDE = 64 };

/* Everything a scene hands out but the tissues, whose numbers are the program's own. */
static uint32_t sum_of(const hs_scene_data *d) {
    const size_t pixels = (size_t)SIDE * SIDE;
    uLong crc = crc32_z(0, d->full.voxels, pixels * SIDE);
    crc = crc32_z(crc, d->truth.voxels, pixels * SIDE);
    crc = crc32_z(crc, d->label, pixels);
    const float *const maps[3] = {d->near_end, d->far_end, d->clip};
    for (int m = 0; m < 3; m++)
        for (size_t i = 0; i < pixels; i++) { /* a NAN has many bit patterns */
            const float value = isnan(maps[m][i]) ? -1.0f : maps[m][i];
            crc = crc32_z(crc, (const Bytef *)&value, sizeof value);
        }
    return (uint32_t)crc;
}

static void nine_cases_are_frozen(void **state) {
    static const struct {
        const char *name;
        uint32_t still, moved; /* frame 0, and frame 7 with seed 99 */
    } frozen[SCENE_CASES] = {
        {"D01", 0x1e69bb77u, 0x0da63e5cu}, {"D02", 0x9b9ff3aeu, 0x1ecff574u},
        {"E01", 0x33f0445au, 0x59c30916u}, {"E02", 0x673c8bc7u, 0x5bb40312u},
        {"E03", 0x711c9c8du, 0x5d5793d7u}, {"E04", 0x48f8aac1u, 0x2a905f4cu},
        {"M01", 0xabffbb1du, 0x18ae932du}, {"M02", 0x922ef417u, 0xd92a75bdu},
        {"M03", 0x44327eebu, 0x2a47112fu},
    };
    int changed = 0;
    for (int c = 0; c < SCENE_CASES; c++) {
        hs_scene_data d = make_scene(frozen[c].name, SIDE, 2, 0, 0);
        const uint32_t still = sum_of(&d);
        d = make_scene(frozen[c].name, SIDE, 2, 99, 7);
        const uint32_t moved = sum_of(&d);
        if (still == frozen[c].still && moved == frozen[c].moved) continue;
        print_error("%s: sums 0x%08x and 0x%08x, expected 0x%08x and 0x%08x\n", frozen[c].name, still, moved,
                    frozen[c].still, frozen[c].moved);
        changed++;
    }
    assert_int_equal(changed, 0);
}

UNIT_MAIN(NULL, NULL, cmocka_unit_test(nine_cases_are_frozen))
