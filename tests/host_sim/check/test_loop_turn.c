/* SPDX-License-Identifier: MIT */
/* Frames that are decided one by one: a loop that is turned, zoomed or given other values draws what a loop
 * that was made so draws. */
#include "loop/loop_run.h"
#include "support/loop_fixture.h"
#include "support/unit.h"

#include <math.h>

static hs_loop_options turnable(const sv_param_value *values, uint32_t count, double yaw, double pitch,
                                double zoom) {
    hs_loop_options o = options_with(values, count);
    o.turnable = true;
    o.lowres = 0;
    o.yaw = yaw;
    o.pitch = pitch;
    o.zoom = zoom;
    return o;
}

/* The result of a frame of the loop as it is, kept for the test. */
static uint8_t *result_of(hs_loop *loop, const hs_dvr_settings *dvr, const hs_cl *cl) {
    hs_error err = {0};
    hs_frame frame = {0};
    uint8_t *rgba = unit_memory((size_t)dvr->width * dvr->height * 4);
    hs_screen *screen = hs_screen_create(cl, dvr, &err);
    assert_true(hs_loop_bring(loop, 0, &err) && hs_loop_convert(loop, 0, &err) &&
                hs_loop_ask(loop, 0, &frame, &err));
    assert_true(frame.clipped);
    assert_true(hs_loop_draw(loop, screen, 0, &frame, &err) && hs_screen_read(screen, rgba, &err));
    hs_screen_destroy(screen);
    return rgba;
}

/* The same of a loop of its own, with a plugin of its own: an instance serves one loop at a time. */
static uint8_t *result_of_new(const fixture *f, const hs_loop_options *o) {
    hs_plugin *plugin = open_plugin("plane");
    hs_loop *loop = make_loop_of(f, plugin, o);
    uint8_t *rgba = result_of(loop, &o->dvr, &f->cl);
    return rgba;
}

/* How many of the bytes differ. */
static size_t count_differences(const uint8_t *a, const uint8_t *b, size_t bytes) {
    size_t count = 0;
    for (size_t i = 0; i < bytes; i++) count += a[i] != b[i];
    return count;
}

static void a_turned_loop_is_one_that_looks_from_there(void **state) {
    const fixture *f = *state;
    const sv_param_value depth = {.id = DEPTH, .value = 12};
    const double views[][4] = {
        {0, 0, 0, 1}, {30, -20, 0, 1}, {-90, 0, 35, 1.5}, {170, 60, 0, 0.5}, {0, 0, 0, 1}};
    hs_loop_options o = turnable(&depth, 1, 0, 0, 1);
    const size_t bytes = (size_t)o.dvr.width * o.dvr.height * 4;
    hs_loop *loop = make_loop(f, &o);
    uint8_t *first = NULL;
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        hs_loop_options there = turnable(&depth, 1, views[i][0], views[i][1], views[i][3]);
        there.roll = views[i][2];
        hs_loop_look(loop, views[i][0], views[i][1], views[i][2], views[i][3]);
        uint8_t *turned = result_of(loop, &o.dvr, &f->cl), *made = result_of_new(f, &there);
        assert_int_equal(count_differences(turned, made, bytes), 0);
        if (i > 0 && i < 4) assert_true(count_differences(turned, first, bytes) > bytes / 20);
        if (!first) first = turned;
    }
}

/* Zoom 2 shows the middle of a picture of twice the size at zoom 1: the same rays. */
static void zoom_shows_the_middle(void **state) {
    const fixture *f = *state;
    const sv_param_value values[2] = {{.id = DEPTH, .value = 3}, {.id = SHAPE, .value = 1}};
    for (int look = 0; look < HS_LOOK_COUNT; look++)
        for (int turned = 0; turned < 2; turned++) {
            hs_loop_options near = options_with(values, 2), far = near;
            near.turnable = far.turnable = turned;
            near.zoom = 2;
            near.dvr.look = far.dvr.look = (hs_look)look;
            const uint32_t side = near.dvr.width;
            far.dvr.width = far.dvr.height = 2 * side;
            uint8_t *a = result_of_new(f, &near), *b = result_of_new(f, &far);
            size_t apart = 0, lit = 0;
            for (uint32_t y = 0; y < side; y++)
                for (uint32_t x = 0; x < side * 4; x++) {
                    const int p = a[y * side * 4 + x], q = b[((y + side / 2) * 2 * side + side / 2) * 4 + x];
                    apart += abs(p - q) > 1; /* rays are placed in float */
                    lit += p != 0;
                }
            assert_true(apart <= (size_t)side * side / 100);
            assert_true(lit > (size_t)side * side);
        }
}

static void a_reactivated_plugin_is_one_that_was_activated_so(void **state) {
    const fixture *f = *state;
    sv_param_value flat[2] = {{.id = DEPTH, .value = 2}, {.id = SHAPE, .value = 0}};
    sv_param_value tilted[2] = {{.id = DEPTH, .value = 2}, {.id = SHAPE, .value = 1}};
    const hs_loop_options before = turnable(flat, 2, 0, 0, 1), after = turnable(tilted, 2, 0, 0, 1);
    const size_t bytes = (size_t)before.dvr.width * before.dvr.height * 4;
    hs_loop *loop = make_loop(f, &before);
    uint8_t *old = result_of(loop, &before.dvr, &f->cl);
    must(hs_loop_reactivate(loop, f->plugin, &after, &err));
    uint8_t *anew = result_of(loop, &before.dvr, &f->cl), *made = result_of_new(f, &after);
    assert_int_equal(count_differences(anew, made, bytes), 0);
    assert_true(count_differences(anew, old, bytes) > 0);
    /* Without a plugin nothing is clipped, and nothing fails. */
    hs_frame frame = {0};
    must(hs_loop_reactivate(loop, NULL, &after, &err));
    must(hs_loop_convert(loop, 0, &err) && hs_loop_ask(loop, 0, &frame, &err));
    assert_false(frame.clipped);
}

/* The box of a turnable loop holds the volume from everywhere, and no view changes it. */
static void one_box_serves_every_direction(void **state) {
    const fixture *f = *state;
    const hs_loop_options o = turnable(NULL, 0, 45, 30, 1);
    const hs_volume *v = &f->layers;
    const double diagonal =
        sqrt(pow(v->nx * v->spacing[0], 2) + pow(v->ny * v->spacing[1], 2) + pow(v->nz * v->spacing[2], 2));
    hs_loop *loop = make_loop(f, &o);
    for (int yaw = -180; yaw <= 180; yaw += 45) {
        hs_camera box, exact, window;
        float share;
        hs_loop_look(loop, yaw, yaw / 2.0, 0, 2);
        hs_loop_camera(loop, 0, &box);
        hs_camera_look(&exact, v, yaw, yaw / 2.0);
        assert_true(fabs(box.extent - diagonal) < 1e-9 && fabs(box.depth_extent - diagonal) < 1e-9);
        assert_true(exact.extent <= box.extent + 1e-9 && exact.depth_extent <= box.depth_extent + 1e-9);
        hs_loop_window(loop, 0, &window, &share);
        assert_true(fabs(window.extent - 0.5 * v->nx * v->spacing[0]) < 1e-9);
        assert_true(fabs((double)share - window.extent / diagonal) < 1e-6);
    }
}

static void a_zoom_out_of_range_is_named(void **state) {
    const fixture *f = *state;
    const double zooms[] = {-1, 33, NAN};
    for (int i = 0; i < 3; i++) {
        const hs_loop_options o = turnable(NULL, 0, 0, 0, zooms[i]);
        must_not(hs_loop_create(&f->cl, &f->source, f->plugin, &o, &err), HS_ERR_USAGE, "camera: zoom");
    }
}

UNIT_MAIN(set_up, tear_down, a_turned_loop_is_one_that_looks_from_there, zoom_shows_the_middle,
          a_reactivated_plugin_is_one_that_was_activated_so, one_box_serves_every_direction,
          a_zoom_out_of_range_is_named)
