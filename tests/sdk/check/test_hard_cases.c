/* SPDX-License-Identifier: MIT */
/*
 * The hard cases of spec 8 that concern ray profiles and the mean filter's numbers. Each is named for what it
 * attacks, and must give the definition's result or a clear status: never NaN, a hang or a crash. Hard places
 * of points are test_method_hard's, for every method.
 */
#include "support/compare.h"

#include <math.h>

static rig_format plain(uint32_t width, uint32_t height, uint32_t slices) {
    return (rig_format){.width = width, .height = height, .slices = slices, .padding = SV_NO_PADDING};
}

/* Runs and checks the volume in all work layouts; `volume` is freed. */
static void in_all_layouts(rig *r, rig_format f, uint8_t *volume, const rig_settings *s, const char *where) {
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        f.fixed[0] = (sv_param_value){rig_param(r, "strategy"), 0, strategy};
        f.fixed[1] = (sv_param_value){rig_param(r, "substeps"), 0, s->substeps};
        compare_run(r, &f, volume, s, where);
    }
}

static uint8_t *constant_volume(const rig_format *f, int value) {
    const size_t count = (size_t)f->width * f->height * f->slices;
    uint8_t *volume = unit_memory(count);
    memset(volume, value, count);
    return volume;
}

/* One value everywhere: no bone, all bone, an empty volume, a plateau exactly at T_L. compare_run asserts the
 * definition's outcome; which one that is, is stated here. */
static void one_value_everywhere(void **state) {
    static const struct {
        const char *name;
        int value;
        int32_t padding;
        double fluid;
        sv_status outcome;
    } table[] = {
        {"an empty volume", 0, SV_NO_PADDING, 40.5 / 255, SV_NO_SURFACE},
        {"an empty volume, all padding", 0, 0, 40.5 / 255, SV_NO_SURFACE},
        {"all bone", 255, SV_NO_PADDING, 40.5 / 255, SV_OK},
        {"all bone, but not scanned", 255, 255, 40.5 / 255, SV_NO_SURFACE},
        {"no bone", 30, SV_NO_PADDING, 40.5 / 255, SV_NO_SURFACE},
        {"a plateau exactly at T_L", 40, SV_NO_PADDING, 40 / 255.0, SV_NO_SURFACE},
        {"a plateau one level above T_L", 41, SV_NO_PADDING, 40 / 255.0, SV_OK},
        {"T_L = 1: nothing is tissue", 255, SV_NO_PADDING, 1.0, SV_NO_SURFACE},
    };
    for (uint32_t n = 0; n < sizeof table / sizeof *table; n++) {
        rig_format f = plain(35, 18, 13);
        f.padding = table[n].padding;
        f.slab_slices = 5;
        rig_settings s = rig_default_settings();
        s.fluid_threshold = table[n].fluid;
        uint8_t *volume = constant_volume(&f, table[n].value);
        const sv_ref_volume v = {volume, f.width, f.height, f.slices, f.padding, NULL};
        rig_expected e = rig_expect(&v, &s, false);
        if (e.outcome != table[n].outcome) fail_msg("'%s': outcome %d", table[n].name, e.outcome);
        for (uint32_t i = 0; i < f.width * f.height; i++) assert_true(e.depth[i] == 0.0f); /* clips nothing */
        in_all_layouts(*state, f, volume, &s, table[n].name);
    }
}

/* The longest volume, 8192 slices: positions of 16 bits with four samples a slice,
 * depths near 10^4 with detail. */
static void longest_volume(void **state) {
    for (uint32_t substeps = 1; substeps <= 4; substeps += 3) {
        enum { SLICES = 8192 };
        rig_format f = plain(5, 3, SLICES);
        f.slab_slices = substeps == 1 ? SLICES : 1000;
        f.tiles_x = 91;
        rig_settings s = rig_default_settings();
        s.substeps = substeps;
        uint8_t *volume = constant_volume(&f, 10);
        for (uint32_t i = 0; i < 15; i++) { /* near ends about 8100, far ends up to 8191 */
            for (uint32_t z = 0; z < 8100 + i; z++) volume[z * 15 + i] = 90;
            volume[(size_t)(SLICES - 1 - i % 4) * 15 + i] = 255;
        }
        in_all_layouts(*state, f, volume, &s, "longest volume");
    }
    (void)compare_print("longest volume");
}

/* Running float32 sums and summed-area tables are off by 1 to 3 slices here: 512 x 512, k = 3, deep
 * values. */
static void float_sums_would_drift(void **state) {
    enum { SIDE = 512, SLICES = 256, RAYS = SIDE * SIDE };
    int32_t *ends = unit_memory(2 * RAYS * sizeof *ends);
    uint32_t seed = 4;
    for (uint32_t i = 0; i < RAYS; i++) {
        seed = seed * 1664525u + 1013904223u;
        ends[i] = (int32_t)(seed >> 25);                                      /* near end 0 .. 127 */
        ends[RAYS + i] = seed % 3 ? (int32_t)(128 + (seed >> 16) % 128) : -1; /* far end 128 .. 255 */
    }
    rig_format f = plain(SIDE, SIDE, SLICES);
    f.slab_slices = 64;
    rig_settings s = rig_default_settings();
    s.k = 3;
    uint8_t *volume = rig_map_volume(ends, ends + RAYS, SIDE, SIDE, SLICES);
    compare_run(*state, &f, volume, &s, "float sums would drift");
    (void)compare_print("float sums would drift");
}

/* Roundings of many passes add up: the widest map, k = 3, points at its left edge only. */
static void many_passes(void **state) {
    enum { WIDTH = 512, HEIGHT = 8, SLICES = 512, RAYS = WIDTH * HEIGHT };
    int32_t *ends = unit_memory(2 * RAYS * sizeof *ends);
    uint32_t seed = 5;
    for (uint32_t i = 0; i < RAYS; i++) {
        seed = seed * 1664525u + 1013904223u;
        ends[RAYS + i] = i % WIDTH < 3 ? (int32_t)(1 + (seed >> 8) % (SLICES - 1)) : -1;
    }
    const rig_format f = plain(WIDTH, HEIGHT, SLICES);
    rig_settings s = rig_default_settings();
    s.k = 3;
    uint8_t *volume = rig_map_volume(ends, ends + RAYS, WIDTH, HEIGHT, SLICES);
    compare_run(*state, &f, volume, &s, "many passes");
    assert_int_equal(compare_print("many passes").max_passes, WIDTH - 3);
}

UNIT_MAIN(NULL, NULL, RIG_TEST(one_value_everywhere), RIG_TEST(longest_volume),
          RIG_TEST(float_sums_would_drift), RIG_TEST(many_passes))
