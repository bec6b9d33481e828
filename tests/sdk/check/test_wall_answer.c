/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall, with answers worked out by hand from the numbers of docs/surface.md: kernels
 * and definition read the same constants, so comparing them says nothing about those.
 * Requirement: R1.
 */
#include "ref/ref_wall_steps.h"
#include "support/wall_fixture.h"

enum {
    DIM = 90,
    BRIGHTER = 95,
    SPREAD_FIFTH = 5 /* the wall is even, so its spread is the least, 0.2 */
};

/* Every ray: wall, fluid, tissue that passes for the fetus with probability p, fluid, the fetus. */
static scan doubtful_rays(int fluid) {
    scan s = scan_make(N, N, N);
    for (uint32_t z = 0; z < N; z++) {
        const int level = z < 12 ? DIM : z >= 24 && z < 34 ? BRIGHTER : z >= 46 ? BONE : fluid;
        for (uint32_t i = 0; i < PIXELS; i++) s.voxels[z * PIXELS + i] = (uint8_t)level;
    }
    scan_run(&s);
    return s;
}

/* The surface lies in the first fluid; the ray pays 8 (1 - p) there for what it leaves, and 5.5 halves the
 * confidence. */
static void test_confidence_of_a_doubtful_ray(void **state) {
    scan s = doubtful_rays(FLUID);
    const double brighter = (log(BRIGHTER / (255.5 - BRIGHTER)) - log(DIM / (255.5 - DIM))) * SPREAD_FIFTH;
    const double p = 1.0 / (1.0 + exp(-5.0 * (brighter - 0.4)));
    const double expected = 1.0 / (1.0 + square(8.0 * (1.0 - p) / 5.5));
    assert_true(p > 0.45 && p < 0.6);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) {
        assert_true(s.depth[i] > 11.0f && s.depth[i] < 24.0f);
        /* p is looked up for whole levels of odds, and costs are integers of 1/128. */
        assert_true(fabs(s.confidence[i] - expected) < 0.01);
    }
}

/* A cost of 5.5 halves the confidence. In a layer as bright as the threshold 1 is added, in one twice as
 * bright four times that. */
static void test_confidence_of_a_cost(void **state) {
    const sv_wall_settings settings = sv_wall_settings_default();
    const sv_wall_layout l = sv_wall_layout_of(N, N, N, (const double[3]){MM, MM, MM}, &settings);
    assert_true(sv_wall_confidence(&l, 0.0f, 0.0f) == 1.0f);
    assert_true(sv_wall_confidence(&l, 5.5f, 0.0f) == 0.5f);
    assert_true(sv_wall_confidence(&l, 4.5f, 1.0f) == 0.5f);
    assert_true(sv_wall_confidence(&l, 1.5f, 2.0f) == 0.5f);
    assert_true(fabs((double)sv_wall_confidence(&l, 11.0f, 0.0f) - 0.2) < 1e-6);
}

/* The same rays are less sure where the fluid of their surface is brighter. With about 97 around, a level of
 * 30 has 0.44 of the threshold, 6 has 0.12: so the cost of about 4 grows by 0.18, which is 0.02 less. */
static void test_bright_fluid_is_less_sure(void **state) {
    enum { HAZE = 30 };
    scan dark = doubtful_rays(FLUID), hazy = doubtful_rays(HAZE);
    assert_int_equal(hazy.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) {
        const double less = (double)(dark.confidence[i] - hazy.confidence[i]);
        assert_true(less > 0.01 && less < 0.04);
    }
}

/* Layers of 2 mm: two slices each, so that no level is smoothed along the rays. */
enum { LAYERS = N / 2 };

/* Runs a scan whose rays have these levels, layer by layer; in columns `from` .. N - 1 the first `dark`
 * layers are fluid. It tells s->beams. */
static void run_layers(scan *s, const uint8_t levels[LAYERS], uint32_t from, uint32_t dark,
                       const sv_wall_settings *settings) {
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t i = 0; i < PIXELS; i++)
            s->voxels[(size_t)z * PIXELS + i] = i % N >= from && z / 2 < dark ? FLUID : levels[z / 2];
    const sv_wall_volume v = {s->voxels, N, N, N, s->first, s->end, {MM, MM, 1.0}, s->beams};
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
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    run_layers(&s, levels, 0, 4, NULL);
    assert_int_equal(s.facts.wall_rays, s.facts.rays);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 23.0f && s.depth[i] <= 40.0f);
    run_layers(&s, levels, 0, 5, NULL);
    assert_int_equal(s.facts.wall_rays, 0);
}

/* A fifth of the rays must begin so, for those that enter by a fan's side have no gel: on fewer rays it is
 * fluid, as in front of a limb near the probe. */
static void test_near_field_is_broad(void **state) {
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    run_layers(&s, levels, N * 75 / 100, 2, NULL);
    assert_int_equal(s.facts.wall_rays, s.facts.rays);
    run_layers(&s, levels, N * 85 / 100, 2, NULL);
    assert_in_range(s.facts.wall_rays, s.facts.rays * 8 / 10, s.facts.rays * 9 / 10);
}

/* The first 5.5 mm of a wall are skin, which may be much brighter: three layers, but not four. */
static void test_skin_tells_nothing(void **state) {
    uint8_t levels[LAYERS];
    scan s = scan_make(N, N, N);
    put_scene(levels, 12, 8);
    memset(levels, BONE + 40, 3);
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - MUSCLE) < 1.0);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 23.0f && s.depth[i] <= 40.0f);
    memset(levels, BONE + 40, 4);
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - (BONE + 40 + MUSCLE) / 2.0) < 1.0); /* a block and the one behind it */
    /* A wall of skin alone is as bright as its last layer. */
    put_scene(levels, 2, 8);
    levels[0] = BONE + 40;
    run_layers(&s, levels, N, 0, NULL);
    assert_true(fabs(s.facts.wall - (MUSCLE + FLUID) / 2.0) < 1.0);
}

/* Four layers of level `front`, a gap of `gap` dark layers, the fetus, whose bone has the level `fetus`, and
 * `elsewhere` dark layers in it. */
static void run_gap_before(scan *s, uint32_t gap, uint8_t fetus, uint32_t elsewhere, uint8_t front,
                           bool clip_doubtful) {
    sv_wall_settings settings = sv_wall_settings_default();
    uint8_t levels[LAYERS];
    uint32_t at = 0;
    if (clip_doubtful) settings.clip_doubtful = true; /* nothing is by default */
    put(levels, &at, 4, front);
    put(levels, &at, gap, FLUID);
    put(levels, &at, 3, fetus);
    put(levels, &at, elsewhere, FLUID);
    put(levels, &at, LAYERS, MUSCLE);
    run_layers(s, levels, N, 0, &settings);
}

static void run_gap(scan *s, uint32_t gap, uint32_t elsewhere, uint8_t front, bool clip_doubtful) {
    run_gap_before(s, gap, BONE, elsewhere, front, clip_doubtful);
}

/* From 0.3 of what is as dark as fluid on there is a surface, and up to a half it is less sure in proportion;
 * below 0.12 there is none. Between them it is doubtful: nothing is clipped, or with a confidence of 0.3 at
 * most. The share counts in thousandths. */
static void test_surface_lies_in_what_is_dark(void **state) {
    scan s = scan_make(N, N, N);
    run_gap(&s, 5, 11, MUSCLE, false); /* 0.3125 */
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    assert_true(fabs(s.facts.gap_share - 5.0 / 16.0) < 1e-9 && s.depth[0] > 7.0f);
    const double sure = (double)s.confidence[0] / (0.312 / 0.5);
    assert_true(sure > 0.9 && sure <= 1.0);
    run_gap(&s, 5, 12, MUSCLE, false); /* 0.294 */
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
    run_gap(&s, 5, 12, MUSCLE, true);
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    for (uint32_t i = 0; i < PIXELS; i++)
        assert_true(s.depth[i] > 7.0f && s.depth[i] <= 18.0f && fabs(s.confidence[i] - 0.3 * sure) < 1e-6);
    run_gap(&s, 2, 14, MUSCLE, false); /* 0.125 */
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    run_gap(&s, 2, 15, MUSCLE, true); /* 0.118, but it is asked for */
    assert_int_equal(s.outcome, SV_WALL_DOUBTFUL);
    assert_true(s.depth[0] > 7.0f);
    run_gap(&s, 2, 15, MUSCLE, false);
    assert_int_equal(s.outcome, SV_WALL_NO_FLUID);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
}

/* A fetus that is no brighter than the wall is none, unless at least 0.45 of what is dark lie before it. */
static void test_clear_fluid_needs_no_bright_fetus(void **state) {
    scan s = scan_make(N, N, N);
    run_gap_before(&s, 5, MUSCLE, 7, BONE, true); /* 0.417 */
    assert_true(s.facts.fetus < 0.1 && fabs(s.facts.wanted - 0.1) < 1e-9);
    assert_int_equal(s.outcome, SV_WALL_NO_FETUS);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] == 0.0f && s.confidence[i] == 0.0f);
    run_gap_before(&s, 5, MUSCLE, 6, BONE, false); /* 0.455 */
    assert_true(s.facts.fetus < 0.1);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 7.0f && s.depth[i] <= 18.0f);
}

/* Out of 1000 dark blocks, so many lie in gaps: what is said after an outcome of the frame before. */
static sv_wall_outcome verdict_after(sv_wall_outcome last, uint64_t in_gaps, bool seen) {
    sv_wall_settings settings = sv_wall_settings_default();
    settings.last = last;
    const sv_wall_layout l = sv_wall_layout_of(N, N, N, (const double[3]){MM, MM, MM}, &settings);
    return sv_wall_verdict(&l, &(const sv_wall_gaps){.dark = 1000, .in_gaps = in_gaps}, seen);
}

/* Limits are 0.02 in favour of what was said of the frame before. Behind frames that told nothing of fluid
 * they are as in a first frame. */
static void test_last_outcome_is_kept(void **state) {
    static const struct {
        sv_wall_outcome last;
        uint64_t doubtful, surface, clear; /* the least of 1000 */
        uint32_t fetus;
    } limits[] = {{SV_WALL_EMPTY, 120, 300, 450, 100},
                  {SV_WALL_NO_FETUS, 120, 300, 470, 120},
                  {SV_WALL_NO_FLUID, 140, 320, 450, 80},
                  {SV_WALL_DOUBTFUL, 100, 320, 450, 80},
                  {SV_WALL_SURFACE, 100, 280, 430, 80}};
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        sv_wall_settings settings = sv_wall_settings_default();
        const sv_wall_outcome last = settings.last = limits[i].last;
        const sv_wall_layout l = sv_wall_layout_of(N, N, N, (const double[3]){MM, MM, MM}, &settings);
        assert_int_equal(sv_wall_fetus_limit(&l), limits[i].fetus);
        assert_int_equal(verdict_after(last, limits[i].doubtful - 1, true), SV_WALL_NO_FLUID);
        assert_int_equal(verdict_after(last, limits[i].doubtful, true), SV_WALL_DOUBTFUL);
        assert_int_equal(verdict_after(last, limits[i].surface - 1, true), SV_WALL_DOUBTFUL);
        assert_int_equal(verdict_after(last, limits[i].surface, true), SV_WALL_SURFACE);
        assert_int_equal(verdict_after(last, limits[i].clear - 1, false), SV_WALL_NO_FETUS);
        assert_int_equal(verdict_after(last, limits[i].clear, false), SV_WALL_SURFACE);
    }
}

/* The threshold where the bright blocks around have this mean, and where a twentieth of the blocks is as dark
 * as fluid. */
static double threshold_at(double bright) {
    return square(0.35 * sqrt(FLUID) + 0.65 * sqrt(bright));
}

/* A dim front is tissue, but no gap lies between it and the fetus: nobody knows what is in front. */
static void test_dim_front_is_no_wall(void **state) {
    scan s = scan_make(N, N, N);
    run_gap(&s, 8, 2, (uint8_t)(0.5 * threshold_at(MUSCLE)), false);
    assert_int_equal(s.facts.wall_rays, s.facts.rays);
    assert_true(s.facts.gap_share == 0.0);
    assert_int_equal(s.outcome, SV_WALL_NO_FLUID);
    run_gap(&s, 8, 2, (uint8_t)(1.2 * threshold_at(BONE)), false);
    assert_true(fabs(s.facts.gap_share - 0.8) < 1e-9);
    /* Below 0.4 of the threshold it is dark; 8 mm of that are no near field. */
    run_gap(&s, 8, 2, (uint8_t)(0.3 * threshold_at(MUSCLE)), false);
    assert_int_equal(s.facts.wall_rays, 0);
}

/* Along the beams it is the wall under a badly lit probe, if it is more than a block deep. */
static void test_dim_front_is_wall_along_the_beams(void **state) {
    const sv_beams straight = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const uint8_t dim = (uint8_t)(0.5 * threshold_at(MUSCLE));
    scan s = scan_make(N, N, N);
    s.beams = &straight;
    run_gap(&s, 8, 2, dim, false);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    assert_true(s.facts.gap_share > 0.7);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(s.depth[i] > 7.0f && s.depth[i] <= 24.0f);
    uint8_t levels[LAYERS];
    uint32_t at = 0;
    put(levels, &at, 1, dim);
    put(levels, &at, 8, FLUID);
    put(levels, &at, 3, BONE);
    put(levels, &at, LAYERS, MUSCLE);
    run_layers(&s, levels, N, 0, NULL);
    assert_true(s.facts.gap_share < 0.1);
}

/* The darkest fifth of all blocks is as dark as fluid: of 32 layers, the seven of the gap that hold it, and
 * not the three in the fetus that are a little brighter. */
static void test_darkest_fifth(void **state) {
    uint8_t levels[LAYERS];
    for (uint32_t gap = 5; gap <= 7; gap += 2) {
        uint32_t at = 0;
        scan s = scan_make(N, N, N);
        put(levels, &at, 6, MUSCLE);
        put(levels, &at, gap, FLUID);
        put(levels, &at, 3, BONE);
        put(levels, &at, 3, FLUID + 3);
        put(levels, &at, LAYERS, MUSCLE);
        run_layers(&s, levels, N, 0, NULL);
        assert_true(fabs(s.facts.gap_share - (gap == 7 ? 1.0 : 5.0 / 8.0)) < 1e-9);
    }
}

UNIT_MAIN(NULL, NULL, test_confidence_of_a_doubtful_ray, test_confidence_of_a_cost,
          test_bright_fluid_is_less_sure, test_near_field_is_no_fluid, test_near_field_is_broad,
          test_skin_tells_nothing, test_surface_lies_in_what_is_dark, test_clear_fluid_needs_no_bright_fetus,
          test_dim_front_is_no_wall, test_dim_front_is_wall_along_the_beams, test_darkest_fifth,
          test_last_outcome_is_kept)
