/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall, with answers worked out by hand from the numbers of docs/surface.md: kernels
 * and definition read the same constants, so comparing them says nothing about those.
 */
#include "support/wall_fixture.h"

#include <string.h>

/* Every ray: wall, fluid, tissue that passes for the fetus with probability p, fluid, the fetus. The surface
 * lies in the first fluid; the ray pays 8 (1 - p) there for what it leaves, and 5 halves the confidence. */
static void test_confidence_of_a_doubtful_ray(void **state) {
    (void)state;
    enum {
        DIM = 90,
        BRIGHTER = 95,
        SPREAD_FIFTH = 5
    }; /* the wall is even, so its spread is the least, 0.2 */
    scan s = scan_make(N, N, N);
    for (uint32_t z = 0; z < N; z++) {
        const int level = z < 12 ? DIM : z >= 24 && z < 34 ? BRIGHTER : z >= 46 ? BONE : FLUID;
        for (uint32_t i = 0; i < PIXELS; i++) s.voxels[z * PIXELS + i] = (uint8_t)level;
    }
    scan_run(&s);
    const double brighter = (log(BRIGHTER / (255.5 - BRIGHTER)) - log(DIM / (255.5 - DIM))) * SPREAD_FIFTH;
    const double p = 1.0 / (1.0 + exp(-5.0 * (brighter - 0.4)));
    const double expected = 1.0 / (1.0 + square(8.0 * (1.0 - p) / 5.0));
    assert_true(p > 0.45 && p < 0.6);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) {
        assert_true(s.depth[i] > 11.0f && s.depth[i] < 24.0f);
        /* p is looked up for whole levels of odds, and costs are integers of 1/128. */
        assert_true(fabs(s.confidence[i] - expected) < 0.01);
    }
    scan_free(&s);
}

/* Layers of 2 mm: two slices each, so that no level is smoothed along the rays. */
enum { LAYERS = N / 2 };

/* Runs a scan whose rays have these levels, layer by layer; in columns `from` .. N - 1 the first `dark`
 * layers are fluid. */
static void run_layers(scan *s, const uint8_t levels[LAYERS], uint32_t from, uint32_t dark,
                       const sv_wall_settings *settings) {
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t i = 0; i < PIXELS; i++)
            s->voxels[(size_t)z * PIXELS + i] = i % N >= from && z / 2 < dark ? FLUID : levels[z / 2];
    const sv_wall_volume v = {s->voxels, N, N, N, s->first, s->end, {MM, MM, 1.0}};
    assert_true(sv_wall_surface(&v, settings, s->depth, s->confidence, &s->outcome, &s->facts));
}

/* Writes `count` layers of a level from `*at` on. */
static void put(uint8_t levels[LAYERS], uint32_t *at, uint32_t count, uint8_t level) {
    for (uint32_t i = 0; i < count && *at < LAYERS; i++) levels[(*at)++] = level;
}

/* Wall, gap, and the fetus, whose bone lies in front. */
static void put_scene(uint8_t levels[LAYERS], uint32_t wall, uint32_t gap) {
    uint32_t at = 0;
    put(levels, &at, wall, MUSCLE);
    put(levels, &at, gap, FLUID);
    put(levels, &at, 3, BONE);
    put(levels, &at, LAYERS, MUSCLE);
}

/* Up to 7.5 mm of darkness in front of the wall are the near field: four layers, but not five. */
static void test_near_field_is_no_fluid(void **state) {
    (void)state;
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    run_layers(&s, levels, 0, 4, NULL);
    assert_int_equal(s.facts.wall_rays, s.facts.rays);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 23.0f && s.depth[i] <= 40.0f);
    run_layers(&s, levels, 0, 5, NULL);
    assert_int_equal(s.facts.wall_rays, 0);
    scan_free(&s);
}

/* Half of the rays must begin so: on fewer rays it is fluid, as in front of a limb near the probe. */
static void test_near_field_is_broad(void **state) {
    (void)state;
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    run_layers(&s, levels, N * 45 / 100, 2, NULL);
    assert_int_equal(s.facts.wall_rays, s.facts.rays);
    run_layers(&s, levels, N * 55 / 100, 2, NULL);
    assert_in_range(s.facts.wall_rays, s.facts.rays / 2, s.facts.rays * 6 / 10);
    scan_free(&s);
}

/* The first 4 mm of a wall are skin, which may be much brighter: two layers, but not three. */
static void test_skin_tells_nothing(void **state) {
    (void)state;
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    memset(levels, BONE + 40, 2);
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - MUSCLE) < 1.0);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 23.0f && s.depth[i] <= 40.0f);
    memset(levels, BONE + 40, 3);
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - (BONE + 40 + MUSCLE) / 2.0) < 1.0); /* a block and the one behind it */
    /* A wall of skin alone is as bright as its last layer. */
    put_scene(levels, 2, 8);
    levels[0] = BONE + 40;
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - (MUSCLE + FLUID) / 2.0) < 1.0);
    scan_free(&s);
}

/* A wall, a gap of `gap` dark layers, and `elsewhere` dark layers in the fetus. In columns `from` .. N - 1
 * the rays begin with two dark layers. */
static void run_gap_from(scan *s, uint32_t gap, uint32_t elsewhere, uint8_t level, uint32_t from,
                         const sv_wall_settings *settings) {
    uint8_t levels[LAYERS];
    uint32_t at = 0;
    put(levels, &at, 4, MUSCLE);
    put(levels, &at, gap, FLUID);
    put(levels, &at, 3, BONE);
    put(levels, &at, elsewhere, level);
    put(levels, &at, LAYERS, MUSCLE);
    run_layers(s, levels, from, 2, settings);
}

/* The same with a wall on all rays, which by itself tells nothing. */
static void run_gap(scan *s, uint32_t gap, uint32_t elsewhere, uint8_t level, bool clip_doubtful) {
    sv_wall_settings settings = sv_wall_settings_default();
    settings.clear_wall_share = 1.1;
    settings.clip_doubtful = clip_doubtful;
    run_gap_from(s, gap, elsewhere, level, N, &settings);
}

/* From 0.43 of all dark blocks on there is a surface; below 0.15 there is none. Between them it is doubtful:
 * nothing is clipped, or with a confidence of 0.3 at most. */
static void test_surface_lies_in_what_is_dark(void **state) {
    (void)state;
    scan s = scan_make(N, N, N);
    run_gap(&s, 7, 9, FLUID, false); /* 0.4375 */
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    assert_true(fabs(s.facts.gap_share - 7.0 / 16.0) < 1e-9 && s.depth[0] > 7.0f && s.confidence[0] > 0.9f);
    run_gap(&s, 6, 8, FLUID, false); /* 0.4286 */
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
    run_gap(&s, 6, 8, FLUID, true);
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    for (uint32_t i = 0; i < PIXELS; i++)
        assert_true(s.depth[i] > 7.0f && s.depth[i] <= 20.0f && fabs(s.confidence[i] - 0.3) < 1e-6);
    run_gap(&s, 3, 16, FLUID, false); /* 0.158 */
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    run_gap(&s, 3, 18, FLUID, true); /* 0.143 */
    assert_int_equal(s.outcome, SV_WALL_NO_FLUID);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
    scan_free(&s);
}

/* A wall on three quarters of the rays tells that there is fluid in front of the fetus, too. */
static void test_clear_wall(void **state) {
    (void)state;
    scan s = scan_make(N, N, N);
    run_gap_from(&s, 6, 9, FLUID, N * 78 / 100, NULL);
    assert_true(s.facts.gap_share < 0.43);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    run_gap_from(&s, 6, 9, FLUID, N * 72 / 100, NULL);
    assert_true(s.facts.gap_share < 0.43);
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    scan_free(&s);
}

/* Dark is at most half of the level above which there is tissue. Haze is fluid, but not dark. */
static void test_half_the_threshold_is_dark(void **state) {
    (void)state;
    scan s = scan_make(N, N, N);
    run_gap(&s, 6, 8, FLUID, false);
    const double bright = (15.0 * MUSCLE + 3.0 * BONE) / 18.0; /* of 32 layers 14 are dark */
    const double limit = (s.facts.threshold + 0.19 * (bright - s.facts.threshold)) / 2.0;
    run_gap(&s, 6, 8, (uint8_t)(0.8 * limit), false);
    assert_true(fabs(s.facts.gap_share - 6.0 / 14.0) < 1e-9);
    run_gap(&s, 6, 8, (uint8_t)(1.3 * limit), false);
    assert_true(s.facts.gap_share == 1.0);
    scan_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_confidence_of_a_doubtful_ray), cmocka_unit_test(test_near_field_is_no_fluid),
        cmocka_unit_test(test_near_field_is_broad),          cmocka_unit_test(test_skin_tells_nothing),
        cmocka_unit_test(test_surface_lies_in_what_is_dark), cmocka_unit_test(test_clear_wall),
        cmocka_unit_test(test_half_the_threshold_is_dark)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
