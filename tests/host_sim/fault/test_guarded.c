/* SPDX-License-Identifier: MIT */
/*
 * Plugins behind the guard. What works comes to the same bits as without it, extensions and texts included;
 * what crashes or leaves costs its frame, is told with its call, and is started anew a few times. (What hangs
 * or takes all memory: test_wrong_plugins.)
 * Requirement: R11.
 */
#include "guarded/guarded.h"
#include "loop/loop_run.h"
#include "plugin/loader_param.h"
#include "support/loop_fixture.h"

static const char *file(const char *name) {
    static char path[1024];
    const char *build = getenv("SV_BUILD_DIR");
    (void)snprintf(path, sizeof path, "%s/%s", build ? build : ".", name);
    return path;
}

static hs_guard_options guard_of(hs_guard_choice choice) {
    hs_guard_options options;
    hs_guard_set_program(file("host_sim"));
    hs_guard_defaults(&options);
    options.choice = choice;
    options.memory_bytes = UINT64_C(1024) << 20;
    return options;
}

static void open_with(hs_plugin *plugin, const char *name, const hs_guard_options *options) {
    must(hs_guarded_open(plugin, file(name), NULL, SV_LOG_ERROR, options, &err));
    assert_int_equal(hs_is_guarded(plugin), options->choice == HS_GUARD_ON);
}

/* ----------------------------------------------------------------------------- the same as without -- */

static void expect_same(const void *a, const void *b, size_t bytes, const char *what, size_t way) {
    if ((a == NULL) != (b == NULL) || (a && memcmp(a, b, bytes) != 0))
        fail_msg("way %zu: another %s", way, what);
}

static void expect_same_view(const hs_view *a, const hs_view *b, size_t way) {
    const size_t rays = (size_t)a->maps.width * a->maps.height;
    assert_int_equal(a->maps.frame.outcome, b->maps.frame.outcome);
    assert_int_equal(a->maps.frame.clipped, b->maps.frame.clipped);
    assert_int_equal(a->maps.frame.has_confidence, b->maps.frame.has_confidence);
    expect_same(a->maps.depth, b->maps.depth, rays * sizeof(float), "depthmap", way);
    expect_same(a->maps.status, b->maps.status, rays, "status map", way);
    expect_same(a->maps.confidence, b->maps.confidence, rays * sizeof(float), "confidence", way);
    expect_same(&a->maps.frame.stats, &b->maps.frame.stats, sizeof a->maps.frame.stats, "statistics", way);
    expect_same(&a->maps.frame.points, &b->maps.frame.points, sizeof a->maps.frame.points, "points", way);
    expect_same(a->result, b->result, (size_t)4 * PICTURE * PICTURE, "picture", way);
}

/* Frames, an adjust and a frame after it, guarded beside unguarded. */
static void compare(const fixture *f, const hs_plugin *direct, const hs_plugin *guarded,
                    const hs_loop_options *o, size_t way) {
    sv_param_info knob;
    hs_loop *loops[] = {make_loop_of(f, direct, o), make_loop_of(f, guarded, o)};
    for (uint32_t i = 0; i < 3; i++) {
        hs_view views[] = {view_of(loops[0], i), view_of(loops[1], i)};
        expect_same_view(&views[0], &views[1], way);
    }
    if (hs_plugin_find_primary(direct, &knob) && (knob.flags & SV_PARAM_ADJUST)) {
        hs_frame frames[2];
        float maps[2][LOW * LOW];
        for (int i = 0; i < 2; i++)
            must(hs_loop_adjust(loops[i], (sv_param_value){.id = knob.id, .value = 0.5}, &frames[i], maps[i],
                                &err));
        assert_true(frames[1].outcome >= SV_OK && frames[0].outcome == frames[1].outcome);
        expect_same(maps[0], maps[1], sizeof maps[0], "map of adjust", way);
    }
    for (int i = 0; i < 2; i++) {
        if (hs_loop_plugin_error(loops[i])->code != HS_OK)
            fail_msg("%s", hs_loop_plugin_error(loops[i])->text);
        end_loop(loops[i]);
    }
}

static void every_way_gives_the_same_bits(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin, *set, *more;
        uint32_t carrier;
        bool own_queue;
    } ways[] = {{"smartvis.so", NULL, NULL, SV_CARRIER_BUFFER, false},
                {"smartvis.so", NULL, NULL, SV_CARRIER_HOST, false},
                {"smartvis.so", NULL, NULL, SV_CARRIER_HOST, true},
                {"smartvis.so", NULL, NULL, SV_CARRIER_IMAGE, false},
                {"smartvis.so", "method=wall", "q=0.3", SV_CARRIER_BUFFER, false},
                {"smartvis.so", "method=wall", NULL, SV_CARRIER_HOST, true},
                {"tests/plugins/confidence_ramp.so", "depth=4", "shape=tilted", SV_CARRIER_BUFFER, false},
                {"tests/plugins/confidence_ramp.so", "depth=4", NULL, SV_CARRIER_HOST, true},
                {"tests/plugins/partial.so", "depth=6", NULL, SV_CARRIER_BUFFER, false}};
    for (size_t n = 0; n < sizeof ways / sizeof *ways; n++) {
        hs_plugin direct, guarded;
        sv_param_value values[2];
        uint32_t count = 0;
        const hs_guard_options off = guard_of(HS_GUARD_OFF), on = guard_of(HS_GUARD_ON);
        open_with(&direct, ways[n].plugin, &off);
        open_with(&guarded, ways[n].plugin, &on);
        if (ways[n].set) must(hs_plugin_parse_param(&guarded, ways[n].set, &values[count++], &err));
        if (ways[n].more) must(hs_plugin_parse_param(&guarded, ways[n].more, &values[count++], &err));
        hs_loop_options o = options_with(values, count);
        o.carrier = ways[n].carrier;
        o.own_queue = ways[n].own_queue;
        o.dvr.ghost_width = 9;
        o.dvr.ghost_doubt = 2;
        o.live = n % 2;
        compare(f, &direct, &guarded, &o, n);
        hs_plugin_close(&direct);
        must(hs_guarded_close(&guarded, &err));
    }
}

static void parameters_tell_the_same(void **state) {
    hs_plugin direct, guarded;
    const hs_guard_options off = guard_of(HS_GUARD_OFF), on = guard_of(HS_GUARD_ON);
    open_with(&direct, "smartvis.so", &off);
    open_with(&guarded, "smartvis.so", &on);
    const uint32_t count = hs_plugin_param_count(&direct);
    assert_int_equal(hs_plugin_param_count(&guarded), count);
    assert_string_equal(direct.descriptor[0]->summary, guarded.descriptor[0]->summary);
    assert_int_equal(direct.descriptor[0]->features, guarded.descriptor[0]->features);
    for (uint32_t i = 0; i < count; i++) {
        sv_param_info a = {.size = sizeof a}, b = {.size = sizeof b};
        char x[128], y[128];
        assert_int_equal(direct.instance->param_info(direct.instance, i, &a), SV_OK);
        assert_int_equal(guarded.instance->param_info(guarded.instance, i, &b), SV_OK);
        assert_string_equal(a.key, b.key);
        assert_string_equal(a.label, b.label);
        assert_string_equal(a.unit, b.unit);
        assert_string_equal(a.help, b.help);
        assert_string_equal(a.group, b.group);
        assert_true(a.id == b.id && a.type == b.type && a.flags == b.flags && a.depends_on == b.depends_on &&
                    a.depends_values == b.depends_values && a.default_value == b.default_value &&
                    a.min_value == b.min_value && a.max_value == b.max_value && a.step == b.step);
        hs_plugin_value_text(&direct, &a, a.default_value, x, sizeof x);
        hs_plugin_value_text(&guarded, &b, b.default_value, y, sizeof y);
        assert_string_equal(x, y);
    }
    hs_plugin_close(&direct);
    hs_plugin_close(&guarded);
}

static void extensions_reach_through(void **state) {
    const fixture *f = *state;
    hs_plugin plugin;
    sv_param_value value;
    const hs_guard_options on = guard_of(HS_GUARD_ON);
    open_with(&plugin, "smartvis.so", &on);
    must(hs_plugin_parse_param(&plugin, "method=spline", &value, &err));
    const hs_loop_options o = options_with(&value, 1);
    hs_loop *loop = make_loop_of(f, &plugin, &o);
    hs_loop_result result;
    must(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &result, &err));
    assert_int_equal(result.failed_frames, 0);
    assert_true(result.has_plugin_stages && result.plugin_stages.profile_ms > 0);
    const sv_ext_timing *timing = hs_plugin_timing(plugin.instance);
    hs_frame frame;
    assert_int_equal(timing->enable(plugin.instance, 1), SV_OK);
    must(hs_loop_frame(loop, HS_SETTING_SMARTVIS, 0, &frame, &err));
    /* A report of an older host is filled no further than its size. */
    const uint32_t older = offsetof(sv_stage_times, threshold_ms);
    sv_stage_times times = {.size = older, .threshold_ms = -7};
    assert_int_equal(timing->stage_times(plugin.instance, &times), SV_OK);
    assert_true(times.profile_ms > 0 && times.threshold_ms < -6 && times.size == older);
    const sv_ext_confidence *confidence = hs_plugin_confidence(plugin.instance);
    assert_true(confidence && !confidence->offered(plugin.instance));
    assert_null(plugin.instance->get_extension(plugin.instance, "nobody/1"));
    end_loop(loop);
    must(hs_guarded_close(&plugin, &err));
}

/* What a plugin needs with these values: status, numbers and reason are the plugin's own. */
static void needs_the_same(const hs_plugin *both, uint32_t size, sv_param_value fixed, sv_param_value own) {
    static const sv_needs_device device = {sizeof device, SV_NEEDS_CPU | SV_NEEDS_DOUBLES, 4, 0};
    const sv_format format = {.size = size,
                              .width = 96,
                              .height = 80,
                              .slices = 64,
                              .max_slab_slices = 16,
                              .voxel_type = SV_VOXEL_U8,
                              .carrier = SV_CARRIER_HOST,
                              .padding_value = SV_NO_PADDING,
                              .tiles_x = 1,
                              .tile_w = 96,
                              .tile_h = 80,
                              .row_pitch = 96,
                              .values = &fixed,
                              .value_count = 1};
    sv_needs needs[2] = {{.size = sizeof *needs}, {.size = sizeof *needs}};
    sv_status status[2];
    for (int i = 0; i < 2; i++)
        status[i] =
            hs_plugin_needs(both[i].instance)->of(both[i].instance, &format, &own, 1, &device, &needs[i]);
    assert_int_equal(status[1], status[0]);
    assert_memory_equal(&needs[1], &needs[0], sizeof *needs);
    assert_true(status[0] != SV_OK || needs[0].commands > 0);
    if (status[0] != SV_OK)
        assert_string_equal(both[1].instance->last_error(both[1].instance),
                            both[0].instance->last_error(both[0].instance));
}

/* A plugin has the extensions that it names, guarded or not. */
static void what_a_plugin_can_do_is_the_same(void **state) {
    hs_plugin both[2];
    sv_param_value spline, mean, far;
    const hs_guard_options off = guard_of(HS_GUARD_OFF), on = guard_of(HS_GUARD_ON);
    (void)state;
    open_with(&both[0], "smartvis.so", &off);
    open_with(&both[1], "smartvis.so", &on);
    const char *const *ids = both[0].instance->descriptor->extensions,
                      *const *told = both[1].instance->descriptor->extensions;
    for (; *ids; ids++, told++) {
        assert_string_equal(*told, *ids);
        if (!both[1].instance->get_extension(both[1].instance, *ids))
            fail_msg("guarded, the plugin has no %s", *ids);
    }
    assert_null(*told);
    must(hs_plugin_parse_param(&both[0], "method=spline", &spline, &err));
    must(hs_plugin_parse_param(&both[0], "method=mean", &mean, &err));
    must(hs_plugin_parse_param(&both[0], "q=0.5", &far, &err));
    needs_the_same(both, sizeof(sv_format), spline, far);
    needs_the_same(both, sizeof(sv_format), mean, far);
    far.value = 99;
    needs_the_same(both, sizeof(sv_format), mean, far);
    needs_the_same(both, 8, mean, far);
    hs_plugin_close(&both[0]);
    must(hs_guarded_close(&both[1], &err));
}

/* --------------------------------------------------------------------------------- what goes wrong -- */

/* Frames 0, 3, 6 and 9 of ten end the child; all others are clipped. */
static void a_crash_costs_its_frame(void **state) {
    const fixture *f = *state;
    static const struct {
        const char *plugin, *says;
        double call;
    } table[] = {
        {"tests/plugins/by_crash.so", ": slab: SV_ERR_INTERNAL (-1): crashed: SIGSEGV in slab 2 of 3",
         FAIL_SLAB},
        {"tests/plugins/by_leave.so", ": end: SV_ERR_INTERNAL (-1): left by exit(0) in end", FAIL_END}};
    for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
        hs_plugin plugin;
        hs_loop_result result;
        hs_guard_options on = guard_of(HS_GUARD_ON);
        on.restarts = 5; /* frame 0 runs twice: once before it counts */
        open_with(&plugin, table[n].plugin, &on);
        const sv_param_value values[3] = {
            {.id = FAIL, .value = table[n].call}, {.id = EVERY, .value = 3}, {.id = DEPTH, .value = 5}};
        const hs_loop_options o = options_with(values, 3);
        hs_loop *loop = make_loop_of(f, &plugin, &o);
        must(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &result, &err));
        assert_int_equal(result.failed_frames, 4);
        assert_int_equal(result.clipped_frames, 6);
        if (!strstr(hs_loop_plugin_error(loop)->text, table[n].says))
            fail_msg("'%s' does not say '%s'", hs_loop_plugin_error(loop)->text, table[n].says);
        end_loop(loop);
        must_not(hs_guarded_close(&plugin, &err), HS_ERR_PLUGIN, "");
    }
}

/* What a new child never saw is no frame before: the first one that it gets says so, and the next does not.
 */
static void a_new_process_is_told_that_it_is_new(void **state) {
    const fixture *f = *state;
    hs_plugin plugin;
    hs_guard_options on = guard_of(HS_GUARD_ON);
    on.restarts = 5;
    open_with(&plugin, "tests/plugins/fresh_told.so", &on);
    const sv_param_value values[3] = {
        {.id = FAIL, .value = FAIL_SLAB}, {.id = EVERY, .value = 3}, {.id = DEPTH, .value = 5}};
    const hs_loop_options o = options_with(values, 3);
    hs_loop *loop = make_loop_of(f, &plugin, &o);
    for (uint32_t i = 0; i < 6; i++) {
        const hs_view view = view_of(loop, i);
        assert_int_equal(view.maps.frame.clipped, i % 3 != 0);
        if (i % 3 != 0) assert_true(view.maps.depth[7] == (i % 3 == 1 ? 6.0f : 5.0f));
    }
    end_loop(loop);
    must_not(hs_guarded_close(&plugin, &err), HS_ERR_PLUGIN, "");
}

static void restarts_are_bounded(void **state) {
    const fixture *f = *state;
    hs_plugin plugin;
    hs_error err = {0};
    hs_loop_result result;
    hs_guard_options on = guard_of(HS_GUARD_ON);
    on.restarts = 2;
    open_with(&plugin, "tests/plugins/by_crash.so", &on);
    const sv_param_value value = {.id = FAIL, .value = FAIL_BEGIN};
    const hs_loop_options o = options_with(&value, 1);
    hs_loop *loop = make_loop_of(f, &plugin, &o);
    assert_true(hs_loop_run(loop, HS_SETTING_SMARTVIS, NULL, &result, &err));
    assert_int_equal(result.failed_frames, FRAMES);
    assert_string_equal(plugin.instance->last_error(plugin.instance),
                        "ended 3 times, and is not started any more");
    assert_non_null(strstr(hs_loop_plugin_error(loop)->text, "crashed: SIGSEGV in begin"));
    end_loop(loop);
    assert_false(hs_guarded_close(&plugin, &err));
}

/* A plugin's own error is told as it is without the guard, and ends no child. */
static void an_error_is_an_error(void **state) {
    const fixture *f = *state;
    char texts[2][1024];
    for (int i = 0; i < 2; i++) {
        hs_plugin plugin;
        const hs_guard_options options = guard_of(i ? HS_GUARD_ON : HS_GUARD_OFF);
        open_with(&plugin, "tests/plugins/plane.so", &options);
        const sv_param_value value = {.id = FAIL, .value = FAIL_SLAB};
        const hs_loop_options o = options_with(&value, 1);
        hs_loop *loop = make_loop_of(f, &plugin, &o);
        hs_view view = view_of(loop, 0);
        assert_int_equal(view.maps.frame.outcome, SV_ERR_INTERNAL);
        (void)snprintf(texts[i], sizeof texts[i], "%s", hs_loop_plugin_error(loop)->text);
        assert_true(hs_guarded_lives(&plugin));
        end_loop(loop);
        must(hs_guarded_close(&plugin, &err));
    }
    assert_string_equal(texts[0], texts[1]);
}

/* On by default for others' libraries, wherever the host's own lies. */
static void who_is_guarded(void **state) {
    hs_guard_options options = guard_of(HS_GUARD_AUTO);
    assert_true(hs_guard_wanted(&options, file("tests/plugins/plane.so")));
    assert_true(hs_guard_wanted(&options, "/nowhere/smartvis.so"));
    options.choice = HS_GUARD_OFF;
    assert_false(hs_guard_wanted(&options, file("tests/plugins/plane.so")));
    options.choice = HS_GUARD_ON;
    assert_true(hs_guard_wanted(&options, file("smartvis.so")));
}

/* The address sanitizer would make an exit of a crash in the child. */
static int set_up_crashes(void **state) {
    const char *options = getenv("ASAN_OPTIONS");
    const char *const more = unit_text("%s:handle_segv=0", options ? options : "");
    if (getenv("SV_SANITIZE")) (void)setenv("ASAN_OPTIONS", more, 1);
    return set_up(state);
}

UNIT_MAIN(set_up_crashes, tear_down, every_way_gives_the_same_bits, parameters_tell_the_same,
          extensions_reach_through, what_a_plugin_can_do_is_the_same, a_crash_costs_its_frame,
          a_new_process_is_told_that_it_is_new, restarts_are_bounded, an_error_is_an_error, who_is_guarded)
