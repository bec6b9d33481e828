/* SPDX-License-Identifier: MIT */
/*
 * The frame path makes nothing, compiles nothing, waits for nothing and allocates nothing: begin, slab, end
 * and adjust in every work layout and with every carrier, seen through interposed OpenCL calls and an
 * interposed heap. With the plugin's own queue, end and adjust wait exactly once. That the spies see what
 * they are there for, the wrong plugins of sv_validate show.
 * Requirement: R6.
 */
#include "core/progress.h"
#include "support/fixture.h"
#include "support/surfaces.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"
#include "validate/spy/library.h"

static void watch(const fixture *f) {
    spy_watch(f->r.entry);
    heap_spy_watch(f->r.entry);
}

static void forget(void) {
    spy_reset();
    heap_spy_reset();
}

/* Since the last forget: no creation, no build, no blocking read or write, no allocation; `waits` calls of
 * clFinish, at least `enqueues` commands. */
static void assert_quiet(const char *call, uint32_t waits, uint32_t enqueues) {
    const struct {
        const char *what;
        uint32_t count, expected;
    } list[] = {{"clCreate...", spy_count(SPY_CREATE), 0},
                {"clBuildProgram", spy_count(SPY_BUILD), 0},
                {"clRelease...", spy_count(SPY_RELEASE), 0},
                {"clFinish", spy_count(SPY_WAIT), waits},
                {"blocking transfers", spy_blocking(), 0},
                {"allocations", heap_spy_count(), 0},
                {"kernels launched for the first time", spy_cold(), 0}};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        if (list[i].count != list[i].expected)
            fail_msg("%s: %s: %u, expected %u", call, list[i].what, list[i].count, list[i].expected);
    if (spy_count(SPY_ENQUEUE) < enqueues) fail_msg("%s: %u commands", call, spy_count(SPY_ENQUEUE));
    forget();
}

static const rig_format ways[] = {{.carrier = SV_CARRIER_HOST},
                                  {.carrier = SV_CARRIER_HOST, .in_place = true},
                                  {.carrier = SV_CARRIER_BUFFER},
                                  {.carrier = SV_CARRIER_IMAGE},
                                  {.own_queue = true},
                                  {.own_queue = true, .in_place = true}};
enum { WAYS = sizeof ways / sizeof *ways };

/* A frame and three turns of the knob; results as `result` says. */
static void quiet_frame(fixture *f, const sv_result *result) {
    const sv_plugin *p = f->r.plugin;
    const uint32_t waits = f->how.own_queue ? 1 : 0;
    const sv_param_value values[] = {{rig_param(&f->r, "q"), 0, 0.5}, {rig_param(&f->r, "kernel"), 0, 3}};
    const sv_frame frame = {.size = sizeof frame, .values = values, .value_count = 2};
    forget();
    assert_int_equal(p->begin(p, &frame), SV_OK);
    assert_quiet("begin", 0, 0);
    for (uint32_t n = 0; n < FIXTURE_SLABS; n++) {
        assert_int_equal(fixture_slab(f, n), SV_OK);
        assert_quiet("slab", 0, n + 1 == FIXTURE_SLABS); /* slabs before the last may share its launch */
    }
    assert_int_equal(p->end(p, result), SV_OK);
    assert_quiet("end", waits, 2);
    const sv_ext_confidence *confidence = p->get_extension(p, SV_EXT_CONFIDENCE);
    static float map[FIXTURE_RAYS];
    if (confidence->offered(p)) {
        forget();
        assert_int_equal(confidence->write(p, map, NULL, 0), SV_OK);
        assert_quiet("confidence", waits, 1);
    }
    for (int n = 0; n < 3; n++) {
        assert_int_equal(p->adjust(p, values, 1, result), SV_OK);
        assert_quiet("adjust", waits, 1);
    }
    assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
}

static void frames_are_quiet(void **state) {
    fixture *f = *state;
    assert_null(library_unknown_import(f->r.library));
    watch(f);
    cl_mem buffer = rig_buffer(&f->r, FIXTURE_RAYS * 4);
    float *wide = unit_memory(FIXTURE_HEIGHT * 256);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method))
        for (uint32_t n = 0; n < 2 * WAYS * 3; n++) {
            const uint32_t way = n / 6, prefilter = n / 3 % 2, strategy = 1 + n % 3;
            /* How slabs come is the same for all methods but wall, which takes them itself. */
            if (way > 0 && (prefilter || (method != SV_METHOD_MEAN && method != SV_METHOD_WALL))) continue;
            rig_format how = ways[way];
            how.fixed[0] = (sv_param_value){rig_param(&f->r, "strategy"), 0, strategy};
            how.fixed[1] = (sv_param_value){rig_param(&f->r, "method"), 0, method};
            how.fixed[2] = (sv_param_value){rig_param(&f->r, "prefilter"), 0, prefilter};
            fixture_use(f, how);
            sv_result result = fixture_result(f);
            quiet_frame(f, &result);
            assert_int_equal(f->out.stats.unfilled, 0);
            result.depth = wide;
            result.depth_pitch = 256;
            result.stats = NULL;
            quiet_frame(f, &result);
            result = (sv_result){.size = sizeof result, .depth_object = buffer};
            if (!how.own_queue) quiet_frame(f, &result);
            if (method == SV_METHOD_MEAN && !prefilter) fixture_frame_is_good(f);
            f->r.plugin->deactivate(f->r.plugin);
            assert_int_equal(spy_live(), 0);
        }
}

/* An error on the frame path is no occasion to allocate either. With its own queue the plugin waits then, so
 * that the host has its slabs and maps back. */
static void refusals_are_quiet(void **state) {
    fixture *f = *state;
    watch(f);
    for (uint32_t n = 0; n < WAYS; n++) {
        fixture_use(f, ways[n]);
        const uint32_t waits = f->how.own_queue ? 1 : 0;
        for (uint32_t slabs = 0; slabs <= FIXTURE_SLABS; slabs++) {
            forget();
            fixture_feed(f, slabs);
            forget();
            assert_int_equal(fixture_slab(f, (slabs + 1) % FIXTURE_SLABS), SV_ERR_SLAB_ORDER);
            assert_quiet("refused slab", waits, 0);
            if (waits) assert_false(spy_pending());
        }
        f->r.plugin->deactivate(f->r.plugin);
    }
}

/* A frame with timing on, and where its time went: within the time that it took, and a transfer only where
 * slabs are copied. Events are kept and released in begin; nothing else changes. */
static sv_stage_times timed_frame(fixture *f, const sv_ext_timing *timing, bool copies) {
    const double start = hs_now();
    forget();
    fixture_frame_is_good(f);
    const double took = 1e3 * (hs_now() - start);
    assert_int_equal(spy_count(SPY_CREATE) + spy_count(SPY_BUILD) + spy_blocking(), 0);
    if (!f->how.own_queue) assert_int_equal(spy_count(SPY_WAIT), 0);
    assert_int_equal(heap_spy_count(), 0);
    sv_stage_times t = {.size = sizeof t};
    assert_int_equal(timing->stage_times(f->r.plugin, &t), SV_OK);
    assert_true(t.profile_ms > 0.0 && t.reconstruct_ms > 0.0 && t.output_ms > 0.0 && t.threshold_ms >= 0.0);
    assert_true(copies ? t.transfer_ms > 0.0 : t.transfer_ms == 0.0);
    assert_true(t.transfer_ms + t.profile_ms + t.threshold_ms + t.reconstruct_ms + t.output_ms < took);
    return t;
}

static void timed_frames(void **state) {
    fixture *f = *state;
    watch(f);
    for (uint32_t n = 0; n < WAYS; n++)
        for (uint32_t strategy = 1; strategy <= 3; strategy++) {
            rig_format how = ways[n];
            how.fixed[0] = (sv_param_value){rig_param(&f->r, "strategy"), 0, strategy};
            fixture_use(f, how);
            const sv_plugin *p = f->r.plugin;
            const sv_ext_timing *timing = p->get_extension(p, SV_EXT_TIMING);
            const bool copies = how.carrier != SV_CARRIER_BUFFER && !(how.in_place && rig_is_cpu(&f->r));
            assert_int_equal(timing->enable(p, 1), SV_OK);
            const sv_stage_times first = timed_frame(f, timing, copies);
            assert_true(strategy == 1 ||
                        first.threshold_ms > 0.0); /* 1: threshold and surface are one launch */
            /* A turn of the knob leaves the times alone, */
            const sv_param_value q = {rig_param(&f->r, "q"), 0, 0.75};
            const sv_result result = fixture_result(f);
            assert_int_equal(p->adjust(p, &q, 1, &result), SV_OK);
            assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
            sv_stage_times again = {.size = sizeof again};
            assert_int_equal(timing->stage_times(p, &again), SV_OK);
            assert_memory_equal(&first, &again, sizeof first);
            /* and the next frame has its own. */
            const int32_t events = spy_live();
            forget();
            assert_int_equal(fixture_begin(f), SV_OK);
            assert_true(spy_count(SPY_RELEASE) > 0 && spy_live() < events);
            const sv_stage_times next = timed_frame(f, timing, copies);
            assert_memory_not_equal(&first, &next, sizeof first);
            assert_int_equal(spy_live(), events);
            p->deactivate(p);
            assert_int_equal(spy_live(), 0);
        }
}

/* What a frame left running on the plugin's own queue is waited for before the host may use its memory again:
 * by a begin that drops it, by an error, and by deactivate, which waits for the host's queue, too. */
static void what_runs_is_waited_for(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    watch(f);
    for (int own = 0; own < 2; own++) {
        rig_format how = {.own_queue = own};
        how.fixed[0] = (sv_param_value){rig_param(&f->r, "method"), 0, 0};
        fixture_use(f, how);
        for (int drop = 0; drop < 3; drop++) {
            fixture_feed(f, FIXTURE_SLABS);
            assert_true(spy_pending());
            forget();
            if (drop == 0) assert_int_equal(fixture_begin(f), SV_OK);
            if (drop == 1) assert_int_equal(fixture_slab(f, 0), SV_ERR_SLAB_ORDER);
            if (drop == 2) p->deactivate(p);
            if (spy_count(SPY_WAIT) == 0 && (own || drop == 2))
                fail_msg("own %d: drop %d did not wait", own, drop);
            assert_int_equal(spy_pending(), !own && drop < 2);
        }
    }
}

/* The self-tests, of the frame and of the method, and the pipeline make their kernels of the same
 * programs. */
static void each_program_is_built_once(void **state) {
    fixture *f = *state;
    watch(f);
    /* spline; wall by rows and by rays, which have a program each */
    static const double methods[] = {2.0, 7.0, 7.0}, strategies[] = {0.0, 1.0, 3.0};
    for (int n = 0; n < 3; n++) {
        rig_format how = {0};
        how.fixed[0] = (sv_param_value){rig_param(&f->r, "method"), 0, methods[n]};
        how.fixed[1] = (sv_param_value){rig_param(&f->r, "strategy"), 0, strategies[n]};
        fixture_change(f, how);
        forget();
        assert_int_equal(fixture_activate(f), SV_OK);
        /* profiles, mean, chain and the method; wall needs its own alone */
        assert_int_equal(spy_count(SPY_BUILD), methods[n] < 7.0 ? 4 : 1);
        f->r.plugin->deactivate(f->r.plugin);
        assert_int_equal(spy_live(), 0);
    }
}

/* PoCL compiles a kernel when it is first launched: activation launches all that frames do, and no other. A
 * frame that clips where fluid is doubtful launches more than others, and so does one that tells its beams.
 * (For the other methods the mean filter's test proves the points that they start from.) */
static void activation_compiles_what_frames_launch(void **state) {
    fixture *f = *state;
    watch(f);
    static const double methods[] = {0.0, 7.0}; /* mean, wall */
    for (uint32_t n = 0; n < 2; n++)
        for (uint32_t strategy = 1; strategy <= 3; strategy++) {
            rig_format how = {.carrier = SV_CARRIER_HOST};
            how.fixed[0] = (sv_param_value){rig_param(&f->r, "strategy"), 0, strategy};
            how.fixed[1] = (sv_param_value){rig_param(&f->r, "method"), 0, methods[n]};
            fixture_use(f, how);
            forget();
            const sv_result result = fixture_result(f);
            const sv_param_value clip = {rig_param(&f->r, "unsure"), 0, rig_enum(&f->r, "unsure", "clip")};
            const sv_frame frame = {.size = sizeof frame,
                                    .values = &clip,
                                    .value_count = 1,
                                    .probe_rotation = {[0] = 1, [4] = 1, [8] = 1},
                                    .probe_side = {0, 0, -1},
                                    .beams = SV_BEAMS_PARALLEL};
            assert_int_equal(f->r.plugin->begin(f->r.plugin, &frame), SV_OK);
            for (uint32_t i = 0; i < FIXTURE_SLABS; i++) assert_int_equal(fixture_slab(f, i), SV_OK);
            assert_int_equal(f->r.plugin->end(f->r.plugin, &result), SV_OK);
            assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
            if (spy_cold() > 0)
                fail_msg("method %g, strategy %u: a frame compiles %u kernels", methods[n], strategy,
                         spy_cold());
            if (spy_idle() > 0)
                fail_msg("method %g, strategy %u: %u kernels are compiled in vain", methods[n], strategy,
                         spy_idle());
            f->r.plugin->deactivate(f->r.plugin);
        }
}

UNIT_MAIN_OF(NULL, NULL, FIXTURE_TEST(each_program_is_built_once), FIXTURE_TEST(frames_are_quiet),
             FIXTURE_TEST(refusals_are_quiet), FIXTURE_TEST(what_runs_is_waited_for),
             FIXTURE_TEST(timed_frames), FIXTURE_TEST(activation_compiles_what_frames_launch))
