/* The renderer's kernels against the scalar definition (ref_dvr.h), and skipping against not skipping. */
#include "host_fixture.h"

#include "ref_dvr.h"

/*
 * Bounds. Kernels compute positions in float: 3 roundings of at most 2^-24 x 64 voxels each, about 1e-5
 * voxel; times 255 grey levels per voxel and axis, over a window of at least 25 levels: at most a few 1e-4 of
 * opacity. A decision closer than that may go either way; such pixels are counted and must be few. All
 * others: the same termination step, and colours within one level, for the rounding to bytes.
 */
#define DECISION_MARGIN 3e-4
#define MAX_CLOSE_SHARE                                                                                      \
    0.05 /* of a case's pixels; margins are spread over 0 .. 1, with up to 100 samples a ray */
#define COLOUR_TOLERANCE 0.51 /* levels: half a level of rounding, and what the float sum adds */

typedef struct {
    uint32_t size[3];
    double spacing[3];
    double yaw, pitch;
    int pattern;
} scene_case;

static const scene_case scenes[] = {
    {{33, 33, 33}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_NOISE},
    {{33, 33, 33}, {1.0, 1.0, 1.0}, 30.0, 20.0, TEST_SPARSE},
    {{40, 25, 31}, {1.0, 0.7, 2.3}, -47.0, 63.0, TEST_SPARSE},
    {{17, 23, 41}, {0.5, 0.5, 0.5}, 90.0, 0.0, TEST_SMOOTH},
    {{17, 23, 11}, {1.0, 1.0, 1.0}, 180.0, 0.0, TEST_CHECKER},
    {{24, 9, 16}, {0.3, 1.1, 0.4}, 13.0, -90.0, TEST_NOISE},
    {{1, 1, 1}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_FULL},
    {{1, 5, 9}, {1.0, 1.0, 1.0}, 25.0, -35.0, TEST_NOISE},
    {{9, 1, 7}, {1.0, 2.0, 1.0}, -60.0, 10.0, TEST_NOISE},
    {{7, 8, 1}, {1.0, 1.0, 1.0}, 0.0, 45.0, TEST_FULL},
    {{16, 16, 16}, {1.0, 1.0, 1.0}, 10.0, 10.0, TEST_EMPTY},
    {{64, 9, 9}, {1.0, 1.0, 1.0}, 5.0, 85.0, TEST_SPARSE},
    {{41, 33, 35}, {1.0, 1.0, 1.0}, 3.0, -4.0, TEST_DOTS},
    {{33, 41, 35}, {1.0, 1.0, 1.0}, 200.0, 50.0, TEST_DOTS},
    {{73, 17, 25}, {1.0, 1.0, 1.0}, 0.0, 0.0, TEST_DOTS},
};

typedef struct {
    uint32_t width, height;
    float low, high, step, termination, offset, ghost;
    int map; /* MAP_* */
} view_case;

enum { MAP_NONE, MAP_RANDOM, MAP_ZERO, MAP_NEGATIVE, MAP_BEYOND, MAP_ODD };

static const view_case views[] = {
    {64, 64, 40.5f / 255.0f, 0.45f, 1.0f, 0.95f, 0.0f, 0.0f, MAP_NONE},
    {37, 29, 40.5f / 255.0f, 0.45f, 1.0f, 0.95f, 0.0f, 0.0f, MAP_RANDOM},
    {37, 29, 40.0f / 255.0f, 0.5f, 0.5f, 0.6f, 3.0f, 0.0f, MAP_RANDOM},
    {32, 40, 0.0f, 1.0f, 1.7f, 0.95f, 4.0f, 6.0f, MAP_RANDOM},
    {33, 17, 0.6f, 0.9f, 1.0f, 2.0f, 10.0f, 10.0f, MAP_RANDOM},
    {16, 16, 0.1f, 0.2f, 1.0f, 0.3f, -2.0f, 3.0f, MAP_ZERO},
    {16, 16, 0.1f, 0.4f, 1.0f, 0.95f, 5.0f, 5.0f, MAP_NEGATIVE},
    {16, 16, 0.1f, 0.4f, 1.0f, 0.95f, 0.0f, 0.0f, MAP_BEYOND},
    {19, 23, 0.2f, 0.4f, 1.0f, 0.95f, 1.0f, 0.0f, MAP_ODD},
    {1, 1, 0.2f, 0.4f, 1.0f, 0.95f, 0.0f, 0.0f, MAP_RANDOM},
    {3, 200, 0.2f, 0.4f, 0.25f, 0.95f, 0.0f, 2.0f, MAP_RANDOM},
};

#define SCENES (sizeof scenes / sizeof scenes[0])
#define VIEWS  (sizeof views / sizeof views[0])
#define MAP_W  7u
#define MAP_H  5u
#define MAP_S  11u

static hs_dvr_settings settings_of(const view_case *v) {
    hs_dvr_settings s;
    hs_dvr_defaults(&s);
    s.width = v->width;
    s.height = v->height;
    s.threshold_low = v->low;
    s.threshold_high = v->high;
    s.step = v->step;
    s.termination = v->termination;
    s.ghost_offset = v->offset;
    s.ghost_width = v->ghost;
    return s;
}

/* MAP_ODD holds what a broken plugin might: NaN and infinities beside depths. */
static void fill_map(test_random *random, int kind, float map[MAP_W * MAP_H]) {
    for (uint32_t i = 0; i < MAP_W * MAP_H; i++) {
        map[i] = (float)test_uniform(random, -2.0, MAP_S + 1.0);
        if (kind == MAP_ZERO) map[i] = 0.0f;
        if (kind == MAP_NEGATIVE) map[i] = -1.0f - map[i] * map[i];
        if (kind == MAP_BEYOND) map[i] = 3.0f * MAP_S + map[i];
        if (kind == MAP_ODD && i % 11 == 3) map[i] = NAN;
        if (kind == MAP_ODD && i % 11 == 6) map[i] = INFINITY;
        if (kind == MAP_ODD && i % 11 == 9) map[i] = -INFINITY;
    }
}

typedef struct {
    uint8_t *rgba, *gray;
    float *termination;
} picture;

static picture render(const hs_cl *cl, const hs_volume *volume, const hs_camera *camera,
                      const hs_dvr_settings *s, const float *map) {
    hs_error err = {HS_OK, ""};
    size_t pixels = (size_t)s->width * s->height;
    picture p = {malloc(pixels * 4), malloc(pixels), malloc(pixels * sizeof(float))};
    assert_true(p.rgba && p.gray && p.termination);
    hs_device_volume *source = hs_device_volume_create(cl, volume, &err);
    hs_dvr *dvr = source ? hs_dvr_create(cl, s, &err) : NULL;
    if (!dvr) fail_msg("%s", err.text);
    hs_start_depths start = {NULL, MAP_W, MAP_H, MAP_S};
    if (map) start.depth = test_buffer(cl, MAP_W * MAP_H * sizeof *map, map);
    cl_mem rgba = test_buffer(cl, pixels * 4, NULL), gray = test_buffer(cl, pixels, NULL);
    cl_mem termination = test_buffer(cl, pixels * sizeof(float), NULL);
    bool ok = hs_dvr_render(dvr, source, camera, map ? &start : NULL, rgba, termination, NULL, &err) &&
              hs_dvr_mip(dvr, source, camera, gray, NULL, &err);
    if (!ok) fail_msg("%s", err.text);
    test_read(cl, rgba, pixels * 4, p.rgba);
    test_read(cl, gray, pixels, p.gray);
    test_read(cl, termination, pixels * sizeof(float), p.termination);
    clReleaseMemObject(rgba);
    clReleaseMemObject(gray);
    clReleaseMemObject(termination);
    if (map) clReleaseMemObject(start.depth);
    hs_dvr_destroy(dvr);
    hs_device_volume_destroy(source);
    return p;
}

static void free_picture(picture *p) {
    free(p->rgba);
    free(p->gray);
    free(p->termination);
}

/* Compares a pixel; true if a decision was too close to be compared. */
static bool compare_pixel(const ref_pixel *expected, const picture *p, size_t i, const char *where) {
    if (fabs((double)p->gray[i] - expected->maximum) > COLOUR_TOLERANCE &&
        expected->margin > DECISION_MARGIN) {
        fail_msg("%s, pixel %zu: MIP %d, expected %.4f", where, i, p->gray[i], expected->maximum);
    }
    assert_int_equal(p->rgba[i * 4 + 3], 255);
    if (expected->margin <= DECISION_MARGIN) return true;
    for (int c = 0; c < 3; c++) {
        if (fabs((double)p->rgba[i * 4 + (size_t)c] - expected->rgb[c]) <= COLOUR_TOLERANCE) continue;
        fail_msg("%s, pixel %zu: channel %d is %d, expected %.4f (margin %.2g)", where, i, c,
                 p->rgba[i * 4 + (size_t)c], expected->rgb[c], expected->margin);
    }
    if ((double)p->termination[i] != expected->termination) {
        fail_msg("%s, pixel %zu: terminates at %.1f, expected %.1f (margin %.2g)", where, i,
                 (double)p->termination[i], expected->termination, expected->margin);
    }
    return false;
}

static void check_case(const hs_cl *cl, size_t scene, size_t view) {
    test_random random = {(uint32_t)(1000 + scene * 97 + view)};
    hs_volume volume = test_volume(&random, scenes[scene].pattern, scenes[scene].size, scenes[scene].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, scenes[scene].yaw, scenes[scene].pitch);
    const hs_dvr_settings s = settings_of(&views[view]);
    float map[MAP_W * MAP_H];
    fill_map(&random, views[view].map, map);
    const ref_depthmap ref_map = {views[view].map == MAP_NONE ? NULL : map, MAP_W, MAP_H, MAP_S};
    picture p = render(cl, &volume, &camera, &s, ref_map.depth);
    char where[64];
    (void)snprintf(where, sizeof where, "scene %zu, view %zu", scene, view);
    size_t close = 0, pixels = (size_t)s.width * s.height;
    for (size_t i = 0; i < pixels; i++) {
        ref_pixel expected =
            ref_dvr_pixel(&volume, &camera, &s, &ref_map, (uint32_t)(i % s.width), (uint32_t)(i / s.width));
        close += compare_pixel(&expected, &p, i, where);
    }
    if ((double)close > MAX_CLOSE_SHARE * (double)pixels + 1.0) {
        fail_msg("%s: %zu of %zu pixels too close to compare", where, close, pixels);
    }
    free_picture(&p);
    hs_volume_free(&volume);
}

static void test_matches_definition(void **state) {
    for (size_t scene = 0; scene < SCENES; scene++) {
        for (size_t view = 0; view < VIEWS; view++) check_case(*state, scene, view);
    }
}

static void assert_same(const picture *a, const picture *b, size_t pixels, size_t scene, size_t view) {
    if (memcmp(a->rgba, b->rgba, pixels * 4) || memcmp(a->gray, b->gray, pixels) ||
        memcmp(a->termination, b->termination, pixels * sizeof(float))) {
        fail_msg("scene %zu, view %zu: pictures differ", scene, view);
    }
}

/* Leaping over transparent bricks must not change a bit, with T_L on a grey level (view 2) too. */
static void test_skipping_changes_nothing(void **state) {
    for (size_t scene = 0; scene < SCENES; scene++) {
        for (size_t view = 0; view < VIEWS; view++) {
            test_random random = {(uint32_t)(77 + scene * 31 + view)};
            hs_volume volume =
                test_volume(&random, scenes[scene].pattern, scenes[scene].size, scenes[scene].spacing);
            hs_camera camera;
            hs_camera_look(&camera, &volume, scenes[scene].yaw, scenes[scene].pitch);
            hs_dvr_settings s = settings_of(&views[view]);
            float map[MAP_W * MAP_H];
            fill_map(&random, views[view].map, map);
            const float *used = views[view].map == MAP_NONE ? NULL : map;
            picture with = render(*state, &volume, &camera, &s, used);
            s.skip_empty = false;
            picture without = render(*state, &volume, &camera, &s, used);
            assert_same(&with, &without, (size_t)s.width * s.height, scene, view);
            free_picture(&with);
            free_picture(&without);
            hs_volume_free(&volume);
        }
    }
}

/* Depths of 0 and below clip nothing, ghosting or not: the very picture without a map. */
static void test_nothing_to_clip(void **state) {
    for (int kind = MAP_ZERO; kind <= MAP_NEGATIVE; kind++) {
        test_random random = {5};
        hs_volume volume = test_volume(&random, TEST_NOISE, scenes[0].size, scenes[0].spacing);
        hs_camera camera;
        hs_camera_look(&camera, &volume, 20.0, -10.0);
        hs_dvr_settings s = settings_of(&views[3]);
        float map[MAP_W * MAP_H];
        fill_map(&random, kind, map);
        picture with = render(*state, &volume, &camera, &s, map),
                full = render(*state, &volume, &camera, &s, NULL);
        assert_same(&with, &full, (size_t)s.width * s.height, 0, 3);
        free_picture(&with);
        free_picture(&full);
        hs_volume_free(&volume);
    }
}

/* A solid cube seen straight on, so that everything can be worked out by hand: step n is slice n, and so is
 * depth n. */
static picture render_solid(const hs_cl *cl, float termination, float depth, float offset, float width) {
    enum { EDGE = MAP_S };
    const uint32_t size[3] = {EDGE, EDGE, EDGE};
    test_random random = {1};
    hs_volume volume = test_volume(&random, TEST_FULL, size, scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    hs_dvr_settings s = settings_of(&views[7]); /* 16 x 16, step 1 */
    s.termination = termination;
    s.ghost_offset = offset;
    s.ghost_width = width;
    float map[MAP_W * MAP_H];
    for (uint32_t i = 0; i < MAP_W * MAP_H; i++) map[i] = depth;
    picture p = render(cl, &volume, &camera, &s, map);
    hs_volume_free(&volume);
    return p;
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
        picture p =
            render_solid(*state, cases[c].termination, cases[c].depth, cases[c].offset, cases[c].width);
        for (size_t i = 0; i < 256; i++) {
            if (p.termination[i] != cases[c].end || p.rgba[i * 4] != cases[c].channel) {
                fail_msg("case %zu, pixel %zu: ends at %.2f with red %d", c, i, (double)p.termination[i],
                         p.rgba[i * 4]);
            }
        }
        free_picture(&p);
    }
}

static void assert_refused(const hs_cl *cl, const hs_dvr_settings *settings, const char *field) {
    hs_error err = {HS_OK, ""};
    assert_null(hs_dvr_create(cl, settings, &err));
    assert_int_equal(err.code, HS_ERR_USAGE);
    if (!strstr(err.text, field)) fail_msg("'%s' does not name %s", err.text, field);
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
    s = good, s.exposure = 0.0f, assert_refused(*state, &s, "exposure");
    s = good, s.skin[2] = 1.5f, assert_refused(*state, &s, "skin[2]");
}

/* Buffers and depthmaps that are too small are errors before anything is enqueued. */
static void test_small_buffers_are_refused(void **state) {
    const hs_cl *cl = *state;
    test_random random = {5};
    hs_error err = {HS_OK, ""};
    hs_volume volume = test_volume(&random, TEST_NOISE, scenes[0].size, scenes[0].spacing);
    hs_camera camera;
    hs_camera_look(&camera, &volume, 0.0, 0.0);
    hs_dvr_settings s = settings_of(&views[7]); /* 16 x 16 */
    hs_device_volume *source = hs_device_volume_create(cl, &volume, &err);
    hs_dvr *dvr = hs_dvr_create(cl, &s, &err);
    cl_mem small = test_buffer(cl, 255, NULL), full = test_buffer(cl, 1024, NULL);
    const hs_start_depths too_large = {small, 8, 8, 8}, empty = {full, 0, 8, 8};
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
    hs_volume_free(&volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_matches_definition),
        cmocka_unit_test(test_skipping_changes_nothing),
        cmocka_unit_test(test_nothing_to_clip),
        cmocka_unit_test(test_known_answers),
        cmocka_unit_test(test_impossible_settings_are_refused),
        cmocka_unit_test(test_small_buffers_are_refused),
    };
    int failed = cmocka_run_group_tests_name("packets", tests, test_open_device, test_close_device);
    return failed + cmocka_run_group_tests_name("single rays", tests, test_open_single, test_close_device);
}
