/* SPDX-License-Identifier: MIT */
/*
 * The plugin's confidence on its way to the ghosting: where it comes the picture is that of
 * its formula; where it does not come, or is none, the picture is the one without it, and the
 * host says so once and goes on.
 * Requirement: R10.
 */
#include "support/loop_fixture.h"

#include "support/ref_dvr.h"

#include <math.h>

enum { PLANE = 8 }; /* slices: step 25, five before the fetus; the occluder ends 13 before it */

/* w = 10 steps before the surface, and up to 3 w more where nothing is sure: as far as the occluder. */
static hs_loop_options ghosted(const sv_param_value *value, bool own_queue, float doubt) {
    hs_loop_options o = options_on(own_queue, value, 1);
    o.dvr.ghost_offset = o.dvr.ghost_width = 10.0f;
    o.dvr.ghost_doubt = doubt;
    return o;
}

/* The view that a plugin's loop gives. */
static hs_view view_by(const fixture *f, const char *name, bool own_queue, float doubt, hs_error *failure) {
    static const sv_param_value depth = {.id = DEPTH, .value = PLANE};
    hs_plugin *plugin = open_plugin(name);
    const hs_loop_options o = ghosted(&depth, own_queue, doubt);
    hs_loop *loop = make_loop_of(f, plugin, &o);
    hs_view view = view_of(loop, 0);
    *failure = *hs_loop_confidence_error(loop);
    assert_int_equal(hs_loop_plugin_error(loop)->code, HS_OK);
    assert_true(view.maps.frame.clipped);
    return view;
}

static bool same_picture(const hs_view *a, const hs_view *b) {
    return memcmp(a->result, b->result, (size_t)PICTURE * PICTURE * 4) == 0 &&
           memcmp(a->termination, b->termination, sizeof(float) * PICTURE * PICTURE) == 0;
}

static void what_is_of_no_use_leaves_the_picture_as_without(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin, *says; /* "": nothing is wrong */
    } cases[] = {{"confidence_full", ""},
                 {"confidence_none", ""},
                 {"confidence_old", ""},
                 {"confidence_fails",
                  "confidence_fails.so: confidence: SV_ERR_INTERNAL (-1): is never sure, on purpose"},
                 {"confidence_nan", "confidence_nan.so: confidence: 1 of 256 values are not in 0 .. 1"},
                 {"confidence_above", "confidence_above.so: confidence: 2 of 256 values are not in 0 .. 1"}};
    for (int own = 0; own < 2; own++) {
        hs_error failure;
        hs_view plain = view_by(f, "plane", own, 2.0f, &failure);
        assert_int_equal(failure.code, HS_OK);
        assert_null(plain.maps.confidence);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            hs_view view = view_by(f, cases[i].plugin, own, 2.0f, &failure);
            if (!same_picture(&view, &plain)) fail_msg("%s: another picture", cases[i].plugin);
            assert_int_equal(view.maps.frame.has_confidence, i == 0);
            assert_int_equal(failure.code, cases[i].says[0] ? HS_ERR_PLUGIN : HS_OK);
            if (!strstr(failure.text, cases[i].says))
                fail_msg("'%s' does not say '%s'", failure.text, cases[i].says);
        }
    }
}

/* The ramp reaches the renderer, by either queue, and gives what the formula says. */
static void a_map_that_is_one_widens_the_window(void **state) {
    const fixture *f = *state;
    hs_view view[2], plain, off;
    hs_error failure;
    for (int own = 0; own < 2; own++) {
        view[own] = view_by(f, "confidence_ramp", own, 3.0f, &failure);
        assert_int_equal(failure.code, HS_OK);
        assert_true(view[own].maps.frame.has_confidence);
        for (int i = 0; i < LOW * LOW; i++)
            assert_true(fabs((double)view[own].maps.confidence[i] - (double)(i % LOW) / (LOW - 1)) < 1e-6);
    }
    plain = view_by(f, "plane", false, 3.0f, &failure);
    off = view_by(f, "confidence_ramp", false, 0.0f, &failure);
    assert_true(same_picture(&view[0], &view[1]));
    assert_true(same_picture(&plain, &off));
    assert_false(same_picture(&view[0], &plain));
    const sv_param_value depth = {.id = DEPTH, .value = PLANE};
    const hs_loop_options o = ghosted(&depth, false, 3.0f);
    const ref_depthmap map = {view[0].maps.depth, view[0].maps.confidence, LOW, LOW, view[0].maps.slices};
    uint32_t sooner = 0, close = 0;
    for (uint32_t i = 0; i < PICTURE * PICTURE; i++) {
        const ref_pixel expected =
            ref_dvr_pixel(&f->layers, &view[0].maps.camera, &o.dvr, &map, i % PICTURE, i / PICTURE);
        sooner += view[0].termination[i] < plain.termination[i];
        close += expected.margin <= 3e-4;
        if (expected.margin > 3e-4) assert_true((double)view[0].termination[i] == expected.termination);
    }
    assert_true(sooner > PICTURE * PICTURE / 8); /* the left of the picture, down to the occluder */
    assert_true(close < PICTURE * PICTURE / 20);
}

/* Every frame of the loop has it, and the knob's pictures too; a hard cut does not ask for it. */
static void every_frame_has_its_own(void **state) {
    const fixture *f = *state;
    static const sv_param_value depth = {.id = DEPTH, .value = PLANE};
    hs_plugin *plugin = open_plugin("confidence_ramp");
    for (int ghost = 0; ghost < 2; ghost++) {
        hs_loop_options o = ghosted(&depth, false, 2.0f);
        if (!ghost) o.dvr.ghost_width = 0.0f;
        hs_loop *loop = make_loop_of(f, plugin, &o);
        for (uint32_t i = 0; i < 3; i++) {
            hs_frame frame;
            must(hs_loop_frame(loop, HS_SETTING_SMARTVIS, i, &frame, &err));
            assert_int_equal(frame.has_confidence, ghost);
        }
    }
}

UNIT_MAIN(set_up, tear_down, what_is_of_no_use_leaves_the_picture_as_without,
          a_map_that_is_one_widens_the_window, every_frame_has_its_own)
