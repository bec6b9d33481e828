/* SPDX-License-Identifier: MIT */
/*
 * Method wall against its definition (docs/surface.md): on scenes, on any volume, by any split into slabs,
 * with ranges, padding and spacing, at any knob position, in both layouts of the work. Everything up to the
 * layers is integer arithmetic, so on a device that divides exactly the maps are the same bits.
 * Requirement: R2.
 */
#include "support/scene_fixture.h"
#include "support/wall_compare.h"

#include <math.h>

/* The nine scenes; a bladder; a fetus whose tissue fades, so that little of what is dark lies before it. */
static void test_scenes(void **state) {
    static const char *const names[] = {"E01", "E02", "E04",  "E03", "M02", "M01",
                                        "H09", "M03", "R9_7", "D02", "D01"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        if (n % 2 && !getenv("SV_NIGHT")) continue; /* every other one by day */
        hs_scene_data data = make_scene(names[n], 96, 2, 1, 0);
        const wall_shape s = {.width = 96, .height = 96, .slices = 96, .slab_slices = 16};
        assert_true(wall_compare(*state, &s, data.full.voxels, names[n]));
        if (n == 0) {
            const uint32_t lengths[] = {96, 1, 7};
            for (size_t i = 0; i < 3; i++) {
                wall_shape other = s;
                other.slab_slices = lengths[i];
                assert_true(wall_compare(*state, &other, data.full.voxels, "other slabs"));
            }
        }
    }
}

/* Sizes that are no multiple of anything, and volumes that are no scans. */
static void test_any_volume(void **state) {
    static const wall_shape shapes[] = {
        {75, 40, 61, 9, 0, {0}, NULL, NULL},    {171, 33, 171, 16, 0, {0}, NULL, NULL},
        {17, 130, 40, 40, -1, {0}, NULL, NULL}, {1, 1, 1, 1, 0, {0}, NULL, NULL},
        {3, 5, 2, 1, 0, {0}, NULL, NULL},       {40, 40, 200, 16, 255, {0}, NULL, NULL},
        {64, 48, 1, 1, -1, {0}, NULL, NULL},    {1, 1, 90, 16, -1, {0}, NULL, NULL},
        {90, 90, 30, 16, 7, {0}, NULL, NULL}};
    static const char *const kinds[] = {"noise", "extremes", "layers", "sparse"};
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++)
        for (int kind = 0; kind < RIG_KIND_COUNT; kind++) {
            const wall_shape *s = &shapes[n];
            uint8_t *volume = rig_volume((rig_kind)kind, s->width, s->height, s->slices, 77 + (uint32_t)n);
            (void)wall_compare(*state, s, volume, kinds[kind]);
        }
}

/* Voxels of other sizes: other windows, labels and cells. */
static void test_spacings(void **state) {
    static const float spacings[][3] = {{1.0f, 1.0f, 1.0f},    {0.9f, 0.9f, 0.9f},   {0.5f, 0.5f, 0.5f},
                                        {0.3f, 0.4f, 0.35f},   {0.15f, 0.2f, 0.12f}, {0.05f, 0.05f, 0.05f},
                                        {0.01f, 3.0f, 0.7f},   {0.9f, 0.9f, 0.2f},   {2.0f, 1.0f, 4.5f},
                                        {20.0f, 20.0f, 20.0f}, {50.0f, 0.7f, 0.7f}};
    uint32_t surfaces = 0;
    for (uint32_t n = 0; n < sizeof spacings / sizeof *spacings; n++) {
        wall_shape s = {.width = 70, .height = 61, .slices = 90, .slab_slices = 16, .padding = SV_NO_PADDING};
        const double longest = 9.0 / (double)spacings[n][2];
        uint8_t *volume = wall_layered_noise(s.width, s.height, s.slices, 10 + (uint32_t)fmin(longest, 30.0),
                                             14 + (uint32_t)fmin(2.5 / (double)spacings[n][1], 36.0), n);
        char what[64];
        memcpy(s.spacing_mm, spacings[n], sizeof s.spacing_mm);
        (void)snprintf(what, sizeof what, "%g, %g, %g mm", (double)s.spacing_mm[0], (double)s.spacing_mm[1],
                       (double)s.spacing_mm[2]);
        surfaces += wall_compare(*state, &s, volume, what);
    }
    assert_true(surfaces >= 6); /* or the test would prove little */
}

/* Ranges that differ from ray to ray, some of them empty: single blocks whose neighbours were not scanned. */
static sv_scanned *ragged_ranges(uint32_t width, uint32_t height, uint32_t slices, uint32_t seed) {
    sv_scanned *ranges = unit_memory((size_t)width * height * sizeof *ranges);
    uint32_t random = seed * 2654435761u + 1;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        const uint32_t first = unit_random(&random) % (slices / 8 + 1);
        const uint32_t end = slices - unit_random(&random) % (slices / 8 + 1);
        if (unit_random(&random) % 19 > 0) ranges[i] = (sv_scanned){(uint16_t)first, (uint16_t)end};
    }
    return ranges;
}

/* Voxels of 1.4 to 2 mm are blocks of their own, which are smoothed: along all axes and along single ones,
 * with ranges and without, padded, in sizes that are no multiple of anything. */
static void test_single_voxels(void **state) {
    static const struct {
        uint32_t size[3];
        float mm[3];
    } cases[] = {{{70, 61, 66}, {1.5f, 1.5f, 1.5f}},  {{67, 71, 59}, {1.8f, 1.8f, 1.8f}},
                 {{65, 45, 53}, {2.0f, 1.9f, 1.6f}},  {{71, 83, 90}, {1.8f, 0.9f, 0.9f}},
                 {{83, 67, 90}, {0.9f, 1.7f, 0.8f}},  {{90, 75, 55}, {0.8f, 0.9f, 1.9f}},
                 {{33, 64, 100}, {1.4f, 1.5f, 1.0f}}, {{31, 1, 70}, {2.0f, 2.0f, 2.0f}},
                 {{1, 29, 64}, {1.8f, 1.8f, 1.8f}},   {{32, 97, 1}, {1.5f, 1.5f, 1.5f}}};
    uint32_t surfaces = 0;
    for (uint32_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const uint32_t width = cases[n].size[0], height = cases[n].size[1], slices = cases[n].size[2];
        uint8_t *volume = wall_layered_noise(width, height, slices, 10, 9, 40 + n);
        sv_scanned *ranges = ragged_ranges(width, height, slices, n);
        for (uint32_t kind = 0; kind < 3; kind++) {
            if (kind != n % 3 && !getenv("SV_NIGHT")) continue; /* one by day */
            const wall_shape s = {.width = width,
                                  .height = height,
                                  .slices = slices,
                                  .slab_slices = 7 + 9 * n % 20,
                                  .padding = kind == 2 ? 4 : SV_NO_PADDING,
                                  .spacing_mm = {cases[n].mm[0], cases[n].mm[1], cases[n].mm[2]},
                                  .scanned = kind > 0 ? ranges : NULL};
            surfaces += wall_compare(*state, &s, volume, "blocks of one voxel");
        }
    }
    assert_true(surfaces >= (getenv("SV_NIGHT") ? 18 : 6));
}

/* No ray begins in a wall: tissue floats in the fluid, or bone begins with the first slice. There the fetus
 * has begun at once. */
static void test_bone_at_once(void **state) {
    const wall_shape s = {.width = 150,
                          .height = 40,
                          .slices = 64,
                          .slab_slices = 16,
                          .padding = SV_NO_PADDING,
                          .spacing_mm = {0.9f, 0.9f, 0.9f}};
    const size_t plane = (size_t)s.width * s.height;
    uint8_t *volume = unit_memory(plane * s.slices);
    uint32_t random = 7;
    for (size_t i = 0; i < plane * s.slices; i++) {
        const size_t x = i % s.width, z = i / plane;
        const int level = x >= 50 || z >= 48 ? 245 : z >= 8 && z < 16 ? 100 : 5;
        volume[i] = (uint8_t)(level + (int)(unit_random(&random) % 10));
    }
    assert_true(wall_compare(*state, &s, volume, "bone at once"));
}

/* A box that is scanned, seen from an edge: around it, before it and behind it nothing was. Rows and vectors
 * of rays have layers of their own, and some have none. */
static void test_turned_box(void **state) {
    enum { W = 133, H = 58, D = 90 };
    static sv_scanned ranges[W * H];
    uint8_t *volume = wall_layered_noise(W, H, D, 24, 14, 9);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            const uint32_t aside = (x > 80 ? x - 80 : 80 - x) / 2, above = y / 6;
            const uint32_t first = 9 + aside + above, end = 85 - above - aside / 3;
            ranges[y * W + x] = (sv_scanned){(uint16_t)D, (uint16_t)D};
            if (y > 5 && y < 49 && aside < 21)
                ranges[y * W + x] = (sv_scanned){(uint16_t)first, (uint16_t)end};
        }
    const float mm[] = {0.3f, 0.7f, 0.9f, 2.0f};
    for (size_t i = 0; i < 4; i++) {
        const wall_shape s = {W, H, D, i % 2 ? 7 : D, SV_NO_PADDING, {mm[i], mm[i], mm[i]}, ranges, NULL};
        assert_true(wall_compare(*state, &s, volume, "a turned box"));
    }
}

/* Ranges of a fan, with rays that were not scanned, with and without a padding value besides. */
static void test_ranges(void **state) {
    enum { W = 70, H = 53, D = 64 };
    static sv_scanned ranges[W * H];
    hs_scene_data data = make_scene("E01", D, 2, 1, 0);
    uint8_t *volume = wall_layered_noise(W, H, D, 12, 14, 9);
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            const uint32_t off = (x > W / 2 ? x - W / 2 : W / 2 - x) / 3 + y / 12;
            ranges[y * W + x] = (sv_scanned){(uint16_t)off, (uint16_t)(D - off / 2)};
            if ((x * 7 + y * 3) % 31 == 0) ranges[y * W + x] = (sv_scanned){9, 9};
            for (uint32_t z = 0; z < D && x < D; z++)
                volume[((size_t)z * H + y) * W + x] = data.full.voxels[((size_t)z * D + y) * D + x];
        }
    const int32_t paddings[] = {SV_NO_PADDING, 0, 4, 255};
    for (size_t i = 0; i < 4; i++) {
        const wall_shape s = {W, H, D, 10, paddings[i], {1.0f, 1.1f, 0.9f}, ranges, NULL};
        assert_true(wall_compare(*state, &s, volume, "ranges of a fan"));
    }
    memset(ranges, 0, sizeof ranges);
    const wall_shape none = {W, H, D, 10, SV_NO_PADDING, {0}, ranges, NULL};
    assert_false(wall_compare(*state, &none, volume, "nothing was scanned"));
}

UNIT_MAIN_OF(NULL, NULL, RIG_TEST(test_scenes), RIG_TEST(test_spacings), RIG_TEST(test_single_voxels),
             RIG_TEST(test_bone_at_once), RIG_TEST(test_any_volume), RIG_TEST(test_ranges),
             RIG_TEST(test_turned_box))
