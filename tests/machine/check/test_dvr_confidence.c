/* SPDX-License-Identifier: MIT */
/*
 * Ghosting with a confidence map (host_sim/render/dvr.h, CONFIDENCE): the kernels against the scalar
 * definition, what must not change a bit, and that less is clipped where less is sure.
 */
#include "support/dvr_fixture.h"

#define ENTRIES (MAP_W * MAP_H)

static void matches_definition(void **state) {
    static const float doubts[] = {0.5f, 2.0f, HS_DVR_MAX_DOUBT};
    for (size_t scene = 0; scene < SCENES; scene++)
        for (size_t view = 0; view < VIEWS; view++)
            dvr_check_case(*state, scene, view, doubts[(scene + view) % 3], true);
}

/* A picture of one scene and view with the given confidence. */
static dvr_picture picture_of(const hs_cl *cl, size_t scene, size_t view, float doubt,
                              const float *confidence) {
    test_random random = {(uint32_t)(40 + scene * 17 + view)};
    hs_camera camera;
    hs_dvr_settings s;
    float map[ENTRIES];
    hs_volume volume = dvr_lay_out(&random, scene, view, doubt, &camera, &s, map);
    return dvr_render(cl, &volume, &camera, &s, dvr_views[view].map == MAP_NONE ? NULL : map, confidence);
}

static void fill(float *confidence, float value) {
    for (uint32_t i = 0; i < ENTRIES; i++) confidence[i] = value;
}

/* The dvr_picture with a confidence of `value` and a growth of `doubt` is that without any, bit for bit. */
static void assert_as_without(const hs_cl *cl, size_t view, float doubt, float value) {
    float confidence[ENTRIES];
    fill(confidence, value);
    for (size_t scene = 0; scene < SCENES; scene++) {
        dvr_picture with = picture_of(cl, scene, view, doubt, confidence);
        dvr_picture without = picture_of(cl, scene, view, 2.0f, NULL);
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
        dvr_picture before = picture_of(*state, 0, view, 2.0f, confidence);
        for (int i = 1; i < 4; i++) {
            fill(confidence, steps[i]);
            dvr_picture now = picture_of(*state, 0, view, 2.0f, confidence);
            for (size_t p = 0; p < pixels; p++) {
                assert_true(now.termination[p] <= before.termination[p]);
                sooner += now.termination[p] < before.termination[p];
            }
            before = now;
        }
    }
    assert_true(sooner > 100);
}

/* A solid cube seen straight on, worked out by hand: the surface lies at step 8, w is 2 and g is 2. */
static void known_answers(void **state) {
    static const struct {
        float confidence, termination, end;
        int red; /* 255 times the opacity at the end */
    } cases[] = {
        {1.0f, 0.95f, 10.0f, 255}, /* factors 0.5 at step 9, 1 at 10 */
        {0.5f, 0.60f, 8.0f, 159},  /* v = 2: 0.25 at 7, 0.5 at 8: 1 - 0.75 * 0.5 = 0.625 */
        {0.0f, 0.90f, 8.0f, 231},  /* v = 4: sixths from 5 on: 1 - 5/6 * 4/6 * 3/6 * 2/6 = 0.9074 */
        {0.0f, 0.30f, 6.0f, 113},  /* 1 - 5/6 * 4/6 = 0.4444 */
        {0.0f, 0.95f, 9.0f, 251},  /* 1 - 5/6 * 4/6 * 3/6 * 2/6 * 1/6 = 0.9846 */
    };
    const uint32_t size[3] = {MAP_S, MAP_S, MAP_S};
    test_random random = {1};
    hs_volume volume = test_volume(&random, TEST_FULL, size, dvr_scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    float map[ENTRIES], confidence[ENTRIES];
    fill(map, 8.0f);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        hs_dvr_settings s = dvr_settings_of(&dvr_views[7]); /* 16 x 16, step 1 */
        s.termination = cases[c].termination;
        s.ghost_width = 2.0f;
        s.ghost_doubt = 2.0f;
        fill(confidence, cases[c].confidence);
        dvr_picture p = dvr_render(*state, &volume, &camera, &s, map, confidence);
        for (size_t i = 0; i < 256; i++)
            if (p.termination[i] != cases[c].end || p.rgba[i * 4] != cases[c].red)
                fail_msg("case %zu, pixel %zu: ends at %.2f with red %d", c, i, (double)p.termination[i],
                         p.rgba[i * 4]);
    }
}

HOST_MAIN(cmocka_unit_test(matches_definition), cmocka_unit_test(what_is_sure_is_drawn_as_ever),
          cmocka_unit_test(less_is_clipped_where_less_is_sure), cmocka_unit_test(known_answers))
