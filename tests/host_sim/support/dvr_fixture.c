/* SPDX-License-Identifier: MIT */
#include "support/dvr_fixture.h"

#include "support/ref_dvr.h"

#include <math.h>

/*
 * Bounds. Kernels compute positions in float: 3 roundings of at most 2^-24 x 64 voxels each, about 1e-5
 * voxel; times 255 grey levels per voxel and axis, over a window of at least 25 levels: at most a few 1e-4 of
 * opacity. A decision closer than that may go either way; such pixels are counted and must be few. All
 * others: the same termination step, and colours within one level, for the rounding to bytes.
 */
#define DECISION_MARGIN 3e-4
/* Of a case's pixels: margins are spread over 0 .. 1, with up to 100 samples a ray. */
#define MAX_CLOSE_SHARE 0.05
/* Levels: half a level of rounding, and what the float sum adds. */
#define COLOUR_TOLERANCE 0.51

const scene_case dvr_scenes[SCENES] = {
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

const view_case dvr_views[VIEWS] = {
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

hs_dvr_settings dvr_settings_of(const view_case *v) {
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

void dvr_fill_map(test_random *random, int kind, float map[MAP_W * MAP_H]) {
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

dvr_picture dvr_render(const hs_cl *cl, const hs_volume *volume, const hs_camera *camera,
                       const hs_dvr_settings *s, const float *map, const float *confidence) {
    hs_error err = {HS_OK, ""};
    size_t pixels = (size_t)s->width * s->height;
    dvr_picture p = {unit_memory(pixels * 4), unit_memory(pixels * sizeof(float))};
    hs_device_volume *source = hs_device_volume_create(cl, volume, &err);
    hs_dvr *dvr = source ? hs_dvr_create(cl, s, &err) : NULL;
    if (!dvr) fail_msg("%s", err.text);
    hs_start_depths start = {.width = MAP_W, .height = MAP_H, .slices = MAP_S};
    if (map) start.depth = test_buffer(cl, MAP_W * MAP_H * sizeof *map, map);
    if (confidence) start.confidence = test_buffer(cl, MAP_W * MAP_H * sizeof *map, confidence);
    cl_mem rgba = test_buffer(cl, pixels * 4, NULL);
    cl_mem termination = test_buffer(cl, pixels * sizeof(float), NULL);
    bool ok = hs_dvr_render(dvr, source, camera, map ? &start : NULL, rgba, termination, NULL, &err);
    if (!ok) fail_msg("%s", err.text);
    test_read(cl, rgba, pixels * 4, p.rgba);
    test_read(cl, termination, pixels * sizeof(float), p.termination);
    clReleaseMemObject(rgba);
    clReleaseMemObject(termination);
    if (start.depth) clReleaseMemObject(start.depth);
    if (start.confidence) clReleaseMemObject(start.confidence);
    hs_dvr_destroy(dvr);
    hs_device_volume_destroy(source);
    return p;
}

/* Compares a pixel; true if a decision was too close to be compared. */
static bool compare_pixel(const ref_pixel *expected, const dvr_picture *p, size_t i, const char *where) {
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

hs_volume dvr_lay_out(test_random *random, size_t scene, size_t view, float doubt, hs_camera *camera,
                      hs_dvr_settings *s, float map[MAP_W * MAP_H]) {
    const scene_case *c = &dvr_scenes[scene];
    hs_volume volume = test_volume(random, c->pattern, c->size, c->spacing);
    hs_camera_look(camera, &volume, c->yaw, c->pitch);
    *s = dvr_settings_of(&dvr_views[view]);
    s->ghost_doubt = doubt;
    dvr_fill_map(random, dvr_views[view].map, map);
    return volume;
}

void dvr_check_case(const hs_cl *cl, size_t scene, size_t view, float doubt, bool with_confidence) {
    test_random random = {(uint32_t)(1000 + scene * 97 + view)};
    hs_camera camera;
    hs_dvr_settings s;
    float map[MAP_W * MAP_H], confidence[MAP_W * MAP_H];
    hs_volume volume = dvr_lay_out(&random, scene, view, doubt, &camera, &s, map);
    for (uint32_t i = 0; i < MAP_W * MAP_H; i++) confidence[i] = (float)test_uniform(&random, 0.0, 1.0);
    const ref_depthmap ref_map = {.depth = dvr_views[view].map == MAP_NONE ? NULL : map,
                                  .confidence = with_confidence ? confidence : NULL,
                                  .width = MAP_W,
                                  .height = MAP_H,
                                  .slices = MAP_S};
    dvr_picture p = dvr_render(cl, &volume, &camera, &s, ref_map.depth, ref_map.confidence);
    const char *const where = unit_text("scene %zu, view %zu", scene, view);
    size_t close = 0, pixels = (size_t)s.width * s.height;
    for (size_t i = 0; i < pixels; i++) {
        ref_pixel expected =
            ref_dvr_pixel(&volume, &camera, &s, &ref_map, (uint32_t)(i % s.width), (uint32_t)(i / s.width));
        close += compare_pixel(&expected, &p, i, where);
    }
    if ((double)close > MAX_CLOSE_SHARE * (double)pixels + 1.0) {
        fail_msg("%s: %zu of %zu pixels too close to compare", where, close, pixels);
    }
}

void dvr_assert_same(const dvr_picture *a, const dvr_picture *b, size_t pixels, size_t scene, size_t view) {
    if (memcmp(a->rgba, b->rgba, pixels * 4) ||
        memcmp(a->termination, b->termination, pixels * sizeof(float))) {
        fail_msg("scene %zu, view %zu: pictures differ", scene, view);
    }
}
