/* SPDX-License-Identifier: MIT */
/* The renderer's kernels against the scalar definition (ref_dvr.h), and skipping against not skipping. */
#include "support/dvr_fixture.h"

#include <math.h>

static void test_matches_definition(void **state) {
    for (size_t scene = 0; scene < SCENES; scene++) {
        for (size_t view = 0; view < VIEWS; view++) dvr_check_case(*state, scene, view, 2.0f, false);
    }
}

/* Leaping over transparent bricks must not change a bit, with T_L on a grey level (view 2) too. */
static void test_skipping_changes_nothing(void **state) {
    for (size_t scene = 0; scene < SCENES; scene++) {
        for (size_t view = 0; view < VIEWS; view++) {
            test_random random = {(uint32_t)(77 + scene * 31 + view)};
            hs_volume volume = test_volume(&random, dvr_scenes[scene].pattern, dvr_scenes[scene].size,
                                           dvr_scenes[scene].spacing);
            hs_camera camera;
            hs_camera_look(&camera, &volume, dvr_scenes[scene].yaw, dvr_scenes[scene].pitch);
            hs_dvr_settings s = dvr_settings_of(&dvr_views[view]);
            float map[MAP_W * MAP_H];
            dvr_fill_map(&random, dvr_views[view].map, map);
            const float *used = dvr_views[view].map == MAP_NONE ? NULL : map;
            dvr_picture with = dvr_render(*state, &volume, &camera, &s, used, NULL);
            s.skip_empty = false;
            dvr_picture without = dvr_render(*state, &volume, &camera, &s, used, NULL);
            dvr_assert_same(&with, &without, (size_t)s.width * s.height, scene, view);
        }
    }
}

/* Depths of 0 and below clip nothing, ghosting or not: the very dvr_picture without a map. */
static void test_nothing_to_clip(void **state) {
    for (int kind = MAP_ZERO; kind <= MAP_NEGATIVE; kind++) {
        test_random random = {5};
        hs_volume volume = test_volume(&random, TEST_NOISE, dvr_scenes[0].size, dvr_scenes[0].spacing);
        hs_camera camera;
        hs_camera_look(&camera, &volume, 20.0, -10.0);
        hs_dvr_settings s = dvr_settings_of(&dvr_views[3]);
        float map[MAP_W * MAP_H];
        dvr_fill_map(&random, kind, map);
        dvr_picture with = dvr_render(*state, &volume, &camera, &s, map, NULL),
                    full = dvr_render(*state, &volume, &camera, &s, NULL, NULL);
        dvr_assert_same(&with, &full, (size_t)s.width * s.height, 0, 3);
    }
}

/* A solid cube seen straight on, so that everything can be worked out by hand: step n
 * is slice n, and so is depth n. */
static dvr_picture render_solid(const hs_cl *cl, float termination, float depth, float offset, float width) {
    enum { EDGE = MAP_S };
    const uint32_t size[3] = {EDGE, EDGE, EDGE};
    test_random random = {1};
    hs_volume volume = test_volume(&random, TEST_FULL, size, dvr_scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    hs_dvr_settings s = dvr_settings_of(&dvr_views[7]); /* 16 x 16, step 1 */
    s.termination = termination;
    s.ghost_offset = offset;
    s.ghost_width = width;
    float map[MAP_W * MAP_H];
    for (uint32_t i = 0; i < MAP_W * MAP_H; i++) map[i] = depth;
    return dvr_render(cl, &volume, &camera, &s, map, NULL);
}

static void test_known_answers(void **state) {
    const struct {
        float termination, depth, offset, width;
        float end;   /* step at which the rays end */
        int channel; /* red, skin 1.0: 255 times the opacity there */
    } cases[] = {
        {1.00f, 0.0f, 0.0f, 0.0f, 0.0f, 255}, /* unclipped: opaque at once, and exactly 1 is enough to end */
        {0.95f, 5.0f, 0.0f, 0.0f, 5.0f, 255}, /* the surface itself is drawn */
        {0.95f, 4.5f, 0.0f, 0.0f, 5.0f, 255}, /* between slices: the next one */
        {0.95f, 5.0f, 2.0f, 0.0f, 3.0f, 255}, /* a hard cut two steps before it */
        {0.95f, 5.0f, 4.0f, 4.0f, 5.0f,
         255}, /* s = w: full opacity at the surface; factors 0.25, 0.5, 0.75, 1 */
        {0.90f, 5.0f, 4.0f, 4.0f, 4.0f, 231}, /* 1 - 0.75 * 0.5 * 0.25 = 0.90625 one step before it */
        {0.60f, 5.0f, 4.0f, 4.0f, 3.0f, 159}, /* 1 - 0.75 * 0.5 = 0.625 */
        {0.95f, 99.0f, 0.0f, 0.0f, 11.0f,
         0}, /* a surface behind the volume: nothing, the ray's whole length */
        {0.95f, 10.0f, 0.0f, 0.0f, 10.0f, 255}, /* the last slice */
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        dvr_picture p =
            render_solid(*state, cases[c].termination, cases[c].depth, cases[c].offset, cases[c].width);
        for (size_t i = 0; i < 256; i++) {
            if (p.termination[i] != cases[c].end || p.rgba[i * 4] != cases[c].channel) {
                fail_msg("case %zu, pixel %zu: ends at %.2f with red %d", c, i, (double)p.termination[i],
                         p.rgba[i * 4]);
            }
        }
    }
}

static void assert_refused(const hs_cl *cl, const hs_dvr_settings *settings, const char *field) {
    hs_error err = {HS_OK, ""};
    assert_null(hs_dvr_create(cl, settings, &err));
    unit_told(err, HS_ERR_USAGE, field);
}

static void test_impossible_settings_are_refused(void **state) {
    hs_dvr_settings good, s;
    hs_dvr_defaults(&good);
    s = good, s.width = 0, assert_refused(*state, &s, "width is 0");
    s = good, s.height = 9000, assert_refused(*state, &s, "height is 9000");
    s = good, s.threshold_high = s.threshold_low, assert_refused(*state, &s, "threshold_high");
    s = good, s.threshold_low = NAN, assert_refused(*state, &s, "threshold_low");
    s = good, s.step = 0.0f, assert_refused(*state, &s, "step");
    s = good, s.termination = 0.0f, assert_refused(*state, &s, "termination");
    s = good, s.ghost_width = -1.0f, assert_refused(*state, &s, "ghost_width");
    s = good, s.ghost_doubt = 17.0f, assert_refused(*state, &s, "ghost_doubt");
    s = good, s.exposure = 0.0f, assert_refused(*state, &s, "exposure");
    s = good, s.skin[2] = 1.5f, assert_refused(*state, &s, "skin[2]");
}

/* Buffers and depthmaps that are too small are errors before anything is enqueued. */
static void test_small_buffers_are_refused(void **state) {
    const hs_cl *cl = *state;
    test_random random = {5};
    hs_error err = {HS_OK, ""};
    hs_volume volume = test_volume(&random, TEST_NOISE, dvr_scenes[0].size, dvr_scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    hs_dvr_settings s = dvr_settings_of(&dvr_views[7]); /* 16 x 16 */
    hs_device_volume *source = hs_device_volume_create(cl, &volume, &err);
    hs_dvr *dvr = hs_dvr_create(cl, &s, &err);
    cl_mem small = test_buffer(cl, 255, NULL), full = test_buffer(cl, 1024, NULL);
    const hs_start_depths too_large = {small, NULL, 8, 8, 8, 0}, empty = {full, NULL, 0, 8, 8, 0},
                          unsure = {full, small, 8, 8, 8, 0};
    assert_true(
        hs_dvr_render(dvr, source, &camera, NULL, NULL, NULL, NULL, &err)); /* both outputs are optional */
    struct {
        const hs_start_depths *start;
        cl_mem rgba, termination;
        hs_code code;
        const char *text;
    } calls[] = {
        {NULL, small, NULL, HS_ERR_DEVICE, "picture has 255 bytes, expected at least 1024"},
        {NULL, full, small, HS_ERR_DEVICE, "termination depths has 255 bytes, expected at least 1024"},
        {&too_large, full, NULL, HS_ERR_DEVICE, "start depths has 255 bytes, expected at least 256"},
        {&unsure, full, NULL, HS_ERR_DEVICE, "the confidence has 255 bytes, expected at least 256"},
        {&empty, full, NULL, HS_ERR_USAGE, "depthmap of 0 x 8"},
    };
    for (size_t i = 0; i < sizeof calls / sizeof calls[0]; i++) {
        hs_error error = {HS_OK, ""};
        assert_false(hs_dvr_render(dvr, source, &camera, calls[i].start, calls[i].rgba, calls[i].termination,
                                   NULL, &error));
        assert_int_equal(error.code, calls[i].code);
        if (!strstr(error.text, calls[i].text)) fail_msg("'%s' lacks '%s'", error.text, calls[i].text);
    }
    assert_false(hs_dvr_mip(dvr, source, &camera, small, NULL, &err));
    clReleaseMemObject(small);
    clReleaseMemObject(full);
    hs_dvr_destroy(dvr);
    hs_device_volume_destroy(source);
}

HOST_MAIN(cmocka_unit_test(test_matches_definition), cmocka_unit_test(test_skipping_changes_nothing),
          cmocka_unit_test(test_nothing_to_clip), cmocka_unit_test(test_known_answers),
          cmocka_unit_test(test_impossible_settings_are_refused),
          cmocka_unit_test(test_small_buffers_are_refused))
