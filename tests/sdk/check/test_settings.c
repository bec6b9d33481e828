/* SPDX-License-Identifier: MIT */
/*
 * Every setting of a frame against the scalar definition, bit for bit, and the float64 one within its bound:
 * windows, weights, thresholds on and between grey levels, the three ways to find T_B, and the knob. That
 * adjust gives the same as a frame: test_methods.
 */
#include "support/compare.h"

enum { WIDTH = 45, HEIGHT = 38, SLICES = 20 };

typedef struct {
    rig *r;
    stage *textures[RIG_KIND_COUNT];
    uint8_t *volumes[RIG_KIND_COUNT];
    rig_format format;
} subject;

static subject open_subject(rig *r, uint32_t strategy) {
    subject b = {.r = r,
                 .format = {.width = WIDTH,
                            .height = HEIGHT,
                            .slices = SLICES,
                            .slab_slices = 7,
                            .padding = SV_NO_PADDING,
                            .fixed = {{rig_param(r, "strategy"), 0, strategy}}}};
    for (uint32_t kind = 0; kind < RIG_KIND_COUNT; kind++) {
        b.volumes[kind] = rig_volume(kind, WIDTH, HEIGHT, SLICES, 11 + strategy);
        b.textures[kind] = rig_stage(r, &b.format, b.volumes[kind]);
    }
    assert_int_equal(r->plugin->activate(r->plugin, &b.textures[0]->format), SV_OK);
    return b;
}

/* Frames 0 .. count - 1 of settings, on every kind of volume in turn, in every layout of the work. */
static void compare_all(rig *r, const char *what, uint32_t count, rig_settings (*settings)(uint32_t n)) {
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        subject b = open_subject(r, strategy);
        for (uint32_t n = 0; n < count; n++) {
            const uint32_t kind = n % RIG_KIND_COUNT;
            const rig_settings s = settings(n);
            compare_frame(r, b.textures[kind], b.volumes[kind], &s, what);
        }
        b.r->plugin->deactivate(b.r->plugin);
    }
    (void)compare_print(what);
}

static rig_settings window(uint32_t n) {
    rig_settings s = rig_default_settings();
    s.k = 3 + 2 * n;
    s.omega = 0.25 * ((n + 1) % 5);
    s.bone.drop_empty = (n + 1) % 3 == 0;
    return s;
}

static rig_settings weight(uint32_t n) {
    rig_settings s = rig_default_settings();
    s.k = n % 2 ? 3 : 9;
    s.omega = 0.25 * (n / RIG_KIND_COUNT);
    return s;
}

static void windows_and_weights(void **state) {
    compare_all(*state, "windows", 31, window);
    compare_all(*state, "weights", 5 * RIG_KIND_COUNT, weight);
}

/* T_L on a grey level, between two, just beside one, at both ends of its range. */
static rig_settings fluid_threshold(uint32_t n) {
    static const double list[] = {
        0.0,         40 / 255.0,    40.5 / 255.0, 41 / 255.0, 39.999 / 255.0, 40.001 / 255.0,
        254 / 255.0, 254.9 / 255.0, 1.0,          1 / 255.0};
    rig_settings s = rig_default_settings();
    s.k = 11;
    s.fluid_threshold = list[n / RIG_KIND_COUNT];
    return s;
}

static void fluid_thresholds(void **state) {
    compare_all(*state, "fluid thresholds", 10 * RIG_KIND_COUNT, fluid_threshold);
}

static rig_settings bone_mode(uint32_t n) {
    static const double absolute[] = {0.0, 0.5, 200 / 255.0, 0.74, 254 / 255.0, 0.9999, 1.0};
    static const double offset[] = {0.0, 1 / 255.0, 0.1, 0.24, 0.5, 0.9999, 1.0};
    static const double fraction[] = {0.0, 1e-6, 0.01, 0.03, 0.5, 0.99, 1.0};
    const uint32_t value = n / RIG_KIND_COUNT % 7;
    rig_settings s = rig_default_settings();
    s.k = 15;
    s.bone.bone_mode = (int)(n / RIG_KIND_COUNT / 7);
    s.bone.bone_threshold = absolute[value];
    s.bone.bone_offset = offset[value];
    s.bone.bone_fraction = fraction[value];
    s.bone.drop_empty = n % 5 == 0;
    return s;
}

static void bone_modes(void **state) {
    compare_all(*state, "bone modes", 3 * 7 * RIG_KIND_COUNT, bone_mode);
}

/* Shares of sure bone rays around what the volumes have, gaps on and between samples of every step. */
static rig_settings share(uint32_t n) {
    static const double shares[] = {0.0, 0.001, 0.25, 0.5, 0.75, 0.999, 1.0};
    static const double gaps[] = {0.0, 0.25, 0.5, 1.0, 1.3, 2.0, 4.75, 64.0};
    rig_settings s = rig_default_settings();
    s.k = 9;
    s.evidence = shares[n % 7];
    s.min_gap = gaps[n / 7];
    s.bone.bone_mode = (int)(n % 3);
    s.bone.drop_empty = n % 2 == 0;
    return s;
}

static void evidence(void **state) {
    compare_all(*state, "evidence", 7 * 8, share);
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(windows_and_weights), RIG_TEST(fluid_thresholds), RIG_TEST(bone_modes),
             RIG_TEST(evidence))
