/* SPDX-License-Identifier: MIT */
/* The scan loop with a plugin that fails, or is not there: every picture must be the unclipped one.
 * Requirement: R10. */
#include "support/loop_fixture.h"

#include <math.h>

/* ------------------------------------------------------------------------------- failing -- */

/* The result must be the full volume's picture, whatever happened. */
static void assert_unclipped(const hs_view *view) {
    assert_false(view->maps.frame.clipped);
    assert_memory_equal(view->result, view->full, (size_t)PICTURE * PICTURE * 4);
    for (size_t r = 0; r < (size_t)LOW * LOW; r++) assert_true(view->maps.depth[r] == 0);
}

static void a_plugin_that_fails_in_any_call_leaves_an_unclipped_picture(void **state) {
    const fixture *f = *state;
    static const struct {
        double call;
        const char *says;
    } cases[] = {{FAIL_ACTIVATE, "plane.so: activate: SV_ERR_INTERNAL (-1): fails in activate on purpose"},
                 {FAIL_BEGIN, "plane.so: begin: SV_ERR_INTERNAL (-1): fails in begin on purpose"},
                 {FAIL_SLAB, "plane.so: slab: SV_ERR_INTERNAL (-1): fails in slab on purpose"},
                 {FAIL_END, "plane.so: end: SV_ERR_INTERNAL (-1): fails in end on purpose"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int own = 0; own < 2; own++) {
            const sv_param_value values[2] = {{.id = FAIL, .value = cases[i].call},
                                              {.id = DEPTH, .value = 5}};
            const hs_loop_options o = options_on(own, values, 2);
            hs_loop *loop = make_loop(f, &o);
            hs_view view = view_of(loop, 0);
            assert_unclipped(&view);
            assert_true(view.maps.frame.outcome < 0);
            assert_int_equal(hs_loop_plugin_error(loop)->code, HS_ERR_PLUGIN);
            assert_non_null(strstr(hs_loop_plugin_error(loop)->text, cases[i].says));
        }
}

/* SV_NO_SURFACE with a map that is not zero: the status counts, not the map. */
static void a_note_is_rendered_unclipped_and_is_no_error(void **state) {
    const fixture *f = *state;
    for (int own = 0; own < 2; own++) {
        const sv_param_value values[2] = {{.id = NOTE, .value = 1}, {.id = DEPTH, .value = 5}};
        const hs_loop_options o = options_on(own, values, 2);
        hs_loop *loop = make_loop(f, &o);
        hs_view view = view_of(loop, 0);
        assert_unclipped(&view);
        assert_int_equal(view.maps.frame.outcome, SV_NO_SURFACE);
        assert_int_equal(hs_loop_plugin_error(loop)->code, HS_OK);
    }
}

static void a_value_the_plugin_refuses_names_it(void **state) {
    const fixture *f = *state;
    const sv_param_value value = {.id = DEPTH, .value = 12345};
    const hs_loop_options o = options_with(&value, 1);
    hs_loop *loop = make_loop(f, &o);
    hs_view view = view_of(loop, 0);
    assert_unclipped(&view);
    assert_int_equal(view.maps.frame.outcome, SV_ERR_PARAM_RANGE);
    assert_non_null(
        strstr(hs_loop_plugin_error(loop)->text, "begin: SV_ERR_PARAM_RANGE (-14): begin: depth is 12345"));
}

/* Frames 0, 3, 6 and 9 of ten fail; the loop goes on and clips the other six. */
static void a_failed_frame_does_not_end_the_loop(void **state) {
    const fixture *f = *state;
    const sv_param_value values[3] = {
        {.id = FAIL, .value = FAIL_END}, {.id = EVERY, .value = 3}, {.id = DEPTH, .value = 5}};
    const hs_loop_options o = options_with(values, 3);
    hs_loop *loop = make_loop(f, &o);
    hs_loop_result result;
    must(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &result, &err));
    assert_int_equal(result.failed_frames, 4);
    assert_int_equal(result.clipped_frames, 6);
    assert_int_equal(result.note_frames, 0);
}

/* Every call succeeds, yet what came of it cannot be meant. On both queues the frame is unclipped, the reason
 * is kept, and an earlier frame's map is not used. */
static void a_frame_that_cannot_be_meant_is_a_failure(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin, *says;
    } table[] = {
        {"depth_nan", "1 of 256 depths were not written, or are not finite"},
        {"depth_far", "1 of 256 depths lie beyond 2 times the volume: with these values its surface leaves"},
        {"depth_endless", "1 of 256 depths were not written"},
        {"map_once", "256 of 256 depths were not written"},
        {"writes_nothing", "returned SV_OK, but wrote no statistics"},
        {"outcome_77", "77"},
        {"outcome_minus_77", "-77"},
        {"begin_77", "begin: unknown status (77)"}};
    for (size_t n = 0; n < 2 * (sizeof table / sizeof *table); n++) {
        hs_plugin *plugin = open_plugin(table[n / 2].plugin);
        hs_loop_options o = options_with(NULL, 0);
        o.own_queue = n % 2;
        if (o.own_queue) o.carrier = SV_CARRIER_HOST;
        hs_loop *loop = make_loop_of(f, plugin, &o);
        hs_view view = view_of(loop, 0);
        view = view_of(loop, 1);
        assert_unclipped(&view);
        assert_true(view.maps.frame.outcome < SV_OK);
        if (!strstr(hs_loop_plugin_error(loop)->text, table[n / 2].says))
            fail_msg("%s: '%s' in '%s'", table[n / 2].plugin, table[n / 2].says,
                     hs_loop_plugin_error(loop)->text);
    }
}

/* Says that all is well, and writes no map. */
static sv_status adjust_without_a_map(const sv_plugin *plugin, const sv_param_value *values, uint32_t count,
                                      const sv_result *result) {
    result->stats->outcome = SV_OK;
    return SV_OK;
}

/* The map of the frame before is no answer of adjust, on neither queue. */
static void an_adjust_that_writes_nothing_is_a_failure(void **state) {
    const fixture *f = *state;
    for (int own = 0; own < 2; own++) {
        static hs_plugin plugin; /* what is given back at the end refers to both */
        static sv_plugin forgetful;
        plugin = *f->plugin;
        forgetful = *f->plugin->instance;
        forgetful.adjust = adjust_without_a_map;
        plugin.instance = &forgetful;
        const sv_param_value depth = {.id = DEPTH, .value = 5};
        const hs_loop_options o = options_on(own, &depth, 1);
        hs_loop *loop = make_loop_of(f, &plugin, &o);
        hs_view view = view_of(loop, 0);
        assert_true(view.maps.frame.clipped);
        hs_frame frame;
        must(hs_loop_adjust(loop, depth, &frame, NULL, &err));
        assert_false(frame.clipped);
        assert_int_equal(frame.outcome, SV_ERR_INTERNAL);
        assert_non_null(strstr(hs_loop_plugin_error(loop)->text, "256 of 256 depths were not written"));
    }
}

static void no_plugin_at_all_renders_unclipped(void **state) {
    const fixture *f = *state;
    const hs_loop_options o = options_with(NULL, 0);
    hs_loop *loop = make_loop_of(f, NULL, &o);
    hs_view view = view_of(loop, 0);
    assert_unclipped(&view);
}

static void impossible_options_are_refused(void **state) {
    const fixture *f = *state;
    hs_loop_options bad[6];
    static const char *const says[6] = {"frames: 0",          "slab: 0 slices",       "carrier: 7",
                                        "needs carrier host", "low resolution: 8193", "must be finite"};
    for (int i = 0; i < 6; i++) bad[i] = options_with(NULL, 0);
    bad[0].frames = 0;
    bad[1].slab_slices = 0;
    bad[2].carrier = 7;
    bad[3].own_queue = true;
    bad[4].lowres = 8193;
    bad[5].yaw = NAN;
    for (int i = 0; i < 6; i++) {
        must_not(hs_loop_create(&f->cl, &f->source, f->plugin, &bad[i], &err), HS_ERR_USAGE, says[i]);
    }
}

UNIT_MAIN(set_up, tear_down, a_plugin_that_fails_in_any_call_leaves_an_unclipped_picture,
          a_note_is_rendered_unclipped_and_is_no_error, a_value_the_plugin_refuses_names_it,
          a_failed_frame_does_not_end_the_loop, a_frame_that_cannot_be_meant_is_a_failure,
          an_adjust_that_writes_nothing_is_a_failure, no_plugin_at_all_renders_unclipped,
          impossible_options_are_refused)
