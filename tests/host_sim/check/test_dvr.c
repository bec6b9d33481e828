/* SPDX-License-Identifier: MIT */
/* The renderer's kernels against the scalar definition (ref_dvr.h), with a confidence map
 * (host_sim/render/dvr.h, CONFIDENCE) and without; what must not change a bit; and that less is clipped where
 * less is sure. */
#include "support/dvr_fixture.h"

#include <math.h>

#define ENTRIES (MAP_W * MAP_H)

static void test_matches_definition(void **state) {
    static const float doubts[] = {0.5f, 2.0f, HS_DVR_MAX_DOUBT};
    for (size_t scene = 0; scene < SCENES; scene++)
        for (size_t view = 0; view < VIEWS; view++)
            dvr_check_case(*state, scene, view, doubts[(scene + view) % 3], (scene + view) % 2);
}

/* A picture of a scene and view, with this confidence or none. */
static dvr_picture picture_of(const hs_cl *cl, size_t scene, size_t view, float doubt,
                              const float *confidence, bool skip) {
    test_random random = {(uint32_t)(40 + scene * 17 + view)};
    hs_camera camera;
    hs_dvr_settings s;
    float map[ENTRIES];
    hs_volume volume = dvr_lay_out(&random, scene, view, doubt, &camera, &s, map);
    s.skip_empty = skip;
    return dvr_render(cl, &volume, &camera, &s, dvr_views[view].map == MAP_NONE ? NULL : map, confidence);
}

static void fill(float *map, float value) {
    for (uint32_t i = 0; i < ENTRIES; i++) map[i] = value;
}

/* Leaping over transparent bricks must not change a bit, with T_L on a grey level (view 2) too. */
static void test_skipping_changes_nothing(void **state) {
    for (size_t scene = 0; scene < SCENES; scene++)
        for (size_t view = 0; view < VIEWS; view++) {
            dvr_picture with = picture_of(*state, scene, view, 2.0f, NULL, true);
            dvr_picture without = picture_of(*state, scene, view, 2.0f, NULL, false);
            dvr_assert_same(&with, &without, (size_t)dvr_views[view].width * dvr_views[view].height, scene,
                            view);
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

/* A solid cube seen straight on, so that everything can be worked out by hand: step n is slice n, and so is
 * depth n. A confidence below 1 makes ghosting grow by twice its width. */
static dvr_picture render_solid(const hs_cl *cl, float termination, float depth, float offset, float width,
                                float sure) {
    const uint32_t size[3] = {MAP_S, MAP_S, MAP_S};
    test_random random = {1};
    hs_volume volume = test_volume(&random, TEST_FULL, size, dvr_scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    hs_dvr_settings s = dvr_settings_of(&dvr_views[7]); /* 16 x 16, step 1 */
    s.termination = termination;
    s.ghost_offset = offset;
    s.ghost_width = width;
    s.ghost_doubt = 2.0f;
    float map[ENTRIES], confidence[ENTRIES];
    fill(map, depth);
    fill(confidence, sure);
    return dvr_render(cl, &volume, &camera, &s, map, confidence);
}

static void test_known_answers(void **state) {
    const struct {
        float termination, depth, offset, width, sure;
        float end;   /* step at which the rays end */
        int channel; /* red, skin 1.0: 255 times the opacity there */
    } cases[] = {
        {1.00f, 0, 0, 0, 1, 0, 255},    /* unclipped: opaque at once, and exactly 1 is enough to end */
        {0.95f, 5, 0, 0, 1, 5, 255},    /* the surface itself is drawn */
        {0.95f, 4.5f, 0, 0, 1, 5, 255}, /* between slices: the next one */
        {0.95f, 5, 2, 0, 1, 3, 255},    /* a hard cut two steps before it */
        {0.95f, 5, 4, 4, 1, 5, 255},    /* s = w: full opacity at the surface; factors 0.25, 0.5, 0.75, 1 */
        {0.90f, 5, 4, 4, 1, 4, 231},    /* 1 - 0.75 * 0.5 * 0.25 = 0.90625 one step before it */
        {0.60f, 5, 4, 4, 1, 3, 159},    /* 1 - 0.75 * 0.5 = 0.625 */
        {0.95f, 99, 0, 0, 1, 11, 0},    /* a surface behind the volume: nothing, the ray's whole length */
        {0.95f, 10, 0, 0, 1, 10, 255},  /* the last slice */
        {0.95f, 8, 0, 2, 1, 10, 255},   /* factors 0.5 at step 9, 1 at 10 */
        {0.60f, 8, 0, 2, 0.5f, 8, 159}, /* v = 2: 0.25 at 7, 0.5 at 8: 1 - 0.75 * 0.5 = 0.625 */
        {0.90f, 8, 0, 2, 0, 8, 231},    /* v = 4: sixths from 5 on: 1 - 5/6 * 4/6 * 3/6 * 2/6 = 0.9074 */
        {0.30f, 8, 0, 2, 0, 6, 113},    /* 1 - 5/6 * 4/6 = 0.4444 */
        {0.95f, 8, 0, 2, 0, 9, 251},    /* 1 - 5/6 * 4/6 * 3/6 * 2/6 * 1/6 = 0.9846 */
    };
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        dvr_picture p = render_solid(*state, cases[c].termination, cases[c].depth, cases[c].offset,
                                     cases[c].width, cases[c].sure);
        for (size_t i = 0; i < 256; i++)
            if (p.termination[i] != cases[c].end || p.rgba[i * 4] != cases[c].channel)
                fail_msg("case %zu, pixel %zu: ends at %.2f with red %d", c, i, (double)p.termination[i],
                         p.rgba[i * 4]);
    }
}

/* The dvr_picture with a confidence of `value` and a growth of `doubt` is that without any, bit for bit. */
static void assert_as_without(const hs_cl *cl, size_t view, float doubt, float value) {
    float confidence[ENTRIES];
    fill(confidence, value);
    for (size_t scene = 0; scene < SCENES; scene++) {
        dvr_picture with = picture_of(cl, scene, view, doubt, confidence, true);
        dvr_picture without = picture_of(cl, scene, view, 2.0f, NULL, true);
        dvr_assert_same(&with, &without, (size_t)dvr_views[view].width * dvr_views[view].height, scene, view);
    }
}

static void what_is_sure_is_drawn_as_ever(void **state) {
    for (size_t view = 0; view < VIEWS; view++) {
        assert_as_without(*state, view, 2.0f, 1.0f);
        assert_as_without(*state, view, 0.0f, 0.25f); /* the host does not want it */
        if (dvr_views[view].ghost == 0.0f) assert_as_without(*state, view, 2.0f, 0.25f); /* a hard cut */
    }
}

/* As confidence falls no ray ends later, and some end sooner. */
static void less_is_clipped_where_less_is_sure(void **state) {
    static const float steps[] = {1.0f, 0.7f, 0.3f, 0.0f};
    uint32_t sooner = 0;
    for (size_t view = 0; view < VIEWS; view++) {
        const size_t pixels = (size_t)dvr_views[view].width * dvr_views[view].height;
        if (dvr_views[view].ghost == 0.0f) continue;
        float confidence[ENTRIES];
        fill(confidence, steps[0]);
        dvr_picture before = picture_of(*state, 0, view, 2.0f, confidence, true);
        for (int i = 1; i < 4; i++) {
            fill(confidence, steps[i]);
            dvr_picture now = picture_of(*state, 0, view, 2.0f, confidence, true);
            for (size_t p = 0; p < pixels; p++) {
                assert_true(now.termination[p] <= before.termination[p]);
                sooner += now.termination[p] < before.termination[p];
            }
            before = now;
        }
    }
    assert_true(sooner > 100);
}

static void assert_refused(const hs_cl *cl, const hs_dvr_settings *settings, const char *field) {
    must_not(hs_dvr_create(cl, settings, &err), HS_ERR_USAGE, field);
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
    clReleaseMemObject(small);
    clReleaseMemObject(full);
    hs_dvr_destroy(dvr);
    hs_device_volume_destroy(source);
}

HOST_MAIN(test_matches_definition, test_skipping_changes_nothing, test_nothing_to_clip, test_known_answers,
          what_is_sure_is_drawn_as_ever, less_is_clipped_where_less_is_sure,
          test_impossible_settings_are_refused, test_small_buffers_are_refused)
