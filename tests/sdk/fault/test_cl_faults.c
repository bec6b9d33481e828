/* SPDX-License-Identifier: MIT */
/*
 * Every OpenCL call of the plugin fails once (SQLite's doctrine: the nth call, for every n): during activate,
 * and during a frame, in every work layout, with every carrier and by every method; and so do its
 * allocations, but under AddressSanitizer, which owns the heap (spy/heap_spy.h). Each time an error with the
 * call's reason, nothing left behind, and the next activation or frame works.
 * Requirement: R7.
 */
#include "programs/shared_programs.h"
#include "support/compare.h"
#include "support/fixture.h"
#include "support/surfaces.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

#include <math.h>

static const cl_int CODE = CL_OUT_OF_HOST_MEMORY;
static const char NAME[] = "CL_OUT_OF_HOST_MEMORY (-6)";

static rig_format with_strategy(const fixture *f, rig_format how, uint32_t strategy) {
    how.fixed[0] = (sv_param_value){rig_param(&f->r, "strategy"), 0, strategy};
    return how;
}

/* A method; the mean filter behind the pre-filter. */
static void choose(fixture *f, int method, uint32_t strategy) {
    rig_format how = with_strategy(f, (rig_format){0}, strategy);
    how.fixed[1] = (sv_param_value){rig_param(&f->r, "method"), 0, method};
    how.fixed[2] = (sv_param_value){rig_param(&f->r, "prefilter"), 0, method == SV_METHOD_MEAN};
    fixture_change(f, how);
}

/* The good frame is that of the method, by which nothing has failed yet. */
static void learn(fixture *f) {
    assert_int_equal(fixture_activate(f), SV_OK);
    for (int i = 0; i < FIXTURE_RAYS; i++) f->out.depth[i] = NAN;
    fixture_feed(f, FIXTURE_SLABS);
    assert_int_equal(fixture_end(f), SV_OK);
    assert_int_equal(f->out.stats.outcome, SV_OK);
    assert_int_equal(f->out.stats.unfilled, 0);
    for (int i = 0; i < FIXTURE_RAYS; i++) assert_true(isfinite(f->out.depth[i]));
    memcpy(f->good.depth, f->out.depth, FIXTURE_RAYS * sizeof(float));
    memcpy(f->good.status, f->out.status, FIXTURE_RAYS);
    f->good.stats.points = f->out.stats.points;
    f->r.plugin->deactivate(f->r.plugin);
}

/* The failure of a search for devices is no error if another search finds one. */
static bool is_search(const char *call) {
    return strcmp(call, "clGetPlatformIDs") == 0 || strcmp(call, "clGetDeviceIDs") == 0;
}

/* One activation whose nth call fails. False if it makes fewer calls. */
static bool activate_failing(fixture *f, uint32_t n) {
    spy_reset();
    spy_fail(n, CODE);
    const sv_status status = fixture_activate(f);
    const char *failed_call = spy_failed();
    const bool fails = failed_call != NULL;
    const char *failed = failed_call ? failed_call : "no call";
    spy_fail(0, 0);
    if (!fails) assert_int_equal(status, SV_OK);
    /* The search asks a platform's name, too: without an answer no kernel cache is looked at. */
    const bool may_fail = is_search(failed) || strcmp(failed, "clGetPlatformInfo") == 0;
    if (fails && status == SV_OK && !may_fail) fail_msg("call %u, %s: failed unnoticed", n, failed);
    if (status == SV_OK) {
        fixture_frame_is_good(f);
        f->r.plugin->deactivate(f->r.plugin);
    } else {
        const bool build = strcmp(failed, "clBuildProgram") == 0;
        const sv_status expected = build               ? SV_ERR_BUILD
                                   : is_search(failed) ? SV_ERR_NO_DEVICE
                                                       : SV_ERR_OPENCL;
        fixture_refused(f, status, expected, NAME);
        assert_int_equal(f->r.last_severity, SV_LOG_ERROR);
        assert_int_equal(fixture_begin(f), SV_ERR_STATE); /* it stayed inactive */
    }
    if (spy_live() != 0) fail_msg("call %u, %s: %d objects left", n, failed, spy_live());
    return fails;
}

/* `every`: 1 for each call. `thin`: further and further apart, for most calls are of kernels, which are
 * alike. */
static uint32_t fail_activations(fixture *f, uint32_t first, uint32_t every, bool thin) {
    uint32_t n = first;
    while (activate_failing(f, n)) n += every + (thin ? n / 16 : 0);
    fixture_works(f);
    f->r.plugin->deactivate(f->r.plugin);
    return n;
}

static void activations(void **state) {
    static const struct {
        rig_format way;
        uint32_t strategy, first, every;
    } table[] = {{{.own_queue = true}, 1, 1, 1},
                 /* The others differ in the self-test's frame and in buffers. */
                 {{.carrier = SV_CARRIER_BUFFER}, 3, 1, 7},
                 {{.in_place = true}, 2, 4, 7}};
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        fixture_change(f, with_strategy(f, table[i].way, table[i].strategy));
        assert_true(fail_activations(f, table[i].first, table[i].every, false) > 100);
    }
}

/* On wide maps a failing kernel set of wide vectors costs only speed: then activate succeeds with 16 rays a
 * vector, and a frame is right. */
static void activate_with_wide_vectors(void **state) {
    rig *r = &((fixture *)*state)->r;
    const rig_format f = {.width = 70, .height = 9, .slices = 6, .padding = SV_NO_PADDING};
    const rig_settings s = rig_default_settings();
    uint8_t *volume = rig_volume(RIG_LAYERS, 70, 9, 6, 1);
    stage *t = rig_stage(r, &f, volume);
    spy_watch(r->entry);
    uint32_t fell_back = 0;
    bool failed = true;
    for (uint32_t n = 2; failed; n += 13) {
        spy_fail(n, CODE);
        const sv_status status = r->plugin->activate(r->plugin, &t->format);
        failed = spy_failed() != NULL;
        spy_fail(0, 0);
        if (status == SV_OK) {
            fell_back += failed;
            compare_frame(r, t, volume, &s, "after a fallback");
            r->plugin->deactivate(r->plugin);
        } else {
            assert_non_null(strstr(r->plugin->last_error(r->plugin), NAME));
        }
        assert_int_equal(spy_live(), 0);
    }
    if (rig_is_cpu(r)) assert_true(fell_back > 3); /* GPUs take 16 rays a vector at once */
}

/* ---- frames ---- */

typedef sv_status (*step)(fixture *f, const sv_result *result);

static sv_status whole_frame(fixture *f, const sv_result *result) {
    sv_status status = fixture_begin(f);
    if (status == SV_OK) status = fixture_slabs(f);
    if (status == SV_OK) status = f->r.plugin->end(f->r.plugin, result);
    return status;
}

static sv_status one_adjust(fixture *f, const sv_result *result) {
    return f->r.plugin->adjust(f->r.plugin, NULL, 0, result);
}

/* A refused slab or map for a failing query, an OpenCL error for the rest. */
static sv_status expected_status(const char *failed) {
    if (strcmp(failed, "clGetImageInfo") == 0) return SV_ERR_SLAB_SHAPE;
    return SV_ERR_OPENCL;
}

static uint32_t fail_steps(fixture *f, step run, const sv_result *result, bool thin) {
    for (uint32_t n = 1;; n += 1 + (thin ? n / 8 : 0)) {
        spy_reset();
        spy_fail(n, CODE);
        const sv_status status = run(f, result);
        const char *failed = spy_failed();
        const bool pending = spy_pending();
        spy_fail(0, 0);
        assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
        if (!failed) {
            assert_int_equal(status, SV_OK);
            return n - 1;
        }
        const bool query = strcmp(failed, "clGetMemObjectInfo") == 0;
        fixture_refused(f, status, query ? status : expected_status(failed), NAME);
        assert_true(status < 0);
        /* With the plugin's own queue nothing may be in flight: the host cannot wait for it. */
        if (f->how.own_queue && pending)
            fail_msg("call %u, %s: commands in flight after an error", n, failed);
        if (run == whole_frame) assert_int_equal(one_adjust(f, result), SV_ERR_STATE);
        if (run == whole_frame) fixture_frame_is_good(f);
    }
}

static const rig_format ways[] = {{.carrier = SV_CARRIER_HOST},
                                  {.in_place = true},
                                  {.carrier = SV_CARRIER_BUFFER},
                                  {.carrier = SV_CARRIER_IMAGE},
                                  {.own_queue = true}};

static void frames(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    uint32_t calls = 0;
    for (uint32_t n = 0; n < sizeof ways / sizeof *ways; n++)
        for (uint32_t strategy = 1; strategy <= 3; strategy++) {
            fixture_use(f, with_strategy(f, ways[n], strategy));
            const int32_t live = spy_live();
            const sv_result result = fixture_result(f);
            calls += fail_steps(f, whole_frame, &result, false);
            calls +=
                fail_steps(f, one_adjust, &result, false); /* the finished frame survives failing adjusts */
            assert_int_equal(spy_live(), live);
            f->r.plugin->deactivate(f->r.plugin);
            assert_int_equal(spy_live(), 0);
        }
    print_message("%u calls failed once\n", calls);
}

/* The device is lost at the nth call, and every later one fails. No call of the ABI hangs or succeeds from
 * then on; deactivate frees all, and the next activation works, as on a device that has come back. */
static void a_lost_device(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    const sv_plugin *p = f->r.plugin;
    for (uint32_t own = 0; own < 2; own++)
        for (uint32_t n = 1; n < 30; n += 4) {
            fixture_change(f, with_strategy(f, (rig_format){.own_queue = own}, 1));
            assert_int_equal(fixture_activate(f), SV_OK);
            const sv_result result = fixture_result(f);
            spy_lose(n, CL_OUT_OF_RESOURCES);
            const sv_status first = whole_frame(f, &result);
            if (!spy_failed()) assert_int_equal(first, SV_OK); /* it was lost behind the frame */
            if (spy_failed()) fixture_refused(f, first, SV_ERR_OPENCL, "CL_OUT_OF_RESOURCES (-5)");
            while (!spy_failed()) (void)one_adjust(f, &result);
            fixture_refused(f, whole_frame(f, &result), SV_ERR_OPENCL, "CL_OUT_OF_RESOURCES (-5)");
            assert_int_equal(one_adjust(f, &result), SV_ERR_STATE);
            p->deactivate(p);
            spy_fail(0, 0);
            assert_int_equal(clFinish(f->r.queue), CL_SUCCESS);
            assert_int_equal(spy_live(), 0);
        }
    fixture_works(f);
}

/* Maps in a buffer, and in rows with a pitch; events kept for timing. */
static void outputs_and_timing(void **state) {
    fixture *f = *state;
    cl_mem buffer = rig_buffer(&f->r, FIXTURE_RAYS * 4);
    float *rows = unit_memory(FIXTURE_HEIGHT * 256);
    spy_watch(f->r.entry);
    const sv_plugin *p = f->r.plugin;
    const sv_ext_timing *stats = p->get_extension(p, SV_EXT_TIMING);
    for (uint32_t timed = 0; timed < 2; timed++) {
        fixture_use(f, (rig_format){0});
        assert_int_equal(stats->enable(p, timed), SV_OK);
        sv_result result = {.size = sizeof result, .depth_object = buffer, .stats = &f->out.stats};
        (void)fail_steps(f, whole_frame, &result, false);
        result = (sv_result){.size = sizeof result, .depth = rows, .depth_pitch = 256};
        (void)fail_steps(f, whole_frame, &result, false);
        spy_fail(1, CODE);
        assert_int_equal(whole_frame(f, &result), SV_ERR_OPENCL);
        sv_stage_times times = {.size = sizeof times};
        assert_int_equal(stats->stage_times(p, &times), SV_ERR_STATE); /* no times of half a frame */
        fixture_frame_is_good(f);
        assert_int_equal(stats->stage_times(p, &times), timed ? SV_OK : SV_ERR_STATE);
        p->deactivate(p);
        assert_int_equal(spy_live(), 0);
    }
}

static void stage_times_of_a_failing_query(void **state) {
    fixture *f = *state;
    const sv_plugin *p = f->r.plugin;
    const sv_ext_timing *stats = p->get_extension(p, SV_EXT_TIMING);
    spy_watch(f->r.entry);
    assert_int_equal(fixture_activate(f), SV_OK);
    assert_int_equal(stats->enable(p, 1), SV_OK);
    fixture_frame_is_good(f);
    sv_stage_times times = {.size = sizeof times};
    for (uint32_t n = 1; n <= 4; n++) {
        spy_fail(n, CL_PROFILING_INFO_NOT_AVAILABLE);
        fixture_refused(f, stats->stage_times(p, &times), SV_ERR_OPENCL,
                        "CL_PROFILING_INFO_NOT_AVAILABLE (-7)");
    }
    spy_fail(0, 0);
    assert_int_equal(stats->stage_times(p, &times), SV_OK);
}

/* ---- methods ---- */

static void methods(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, 1);
        learn(f);
        assert_true(fail_activations(f, 1, 3, true) > 100);
        choose(f, method, 2);
        learn(f);
        assert_int_equal(fixture_activate(f), SV_OK);
        const sv_result result = fixture_result(f);
        (void)fail_steps(f, whole_frame, &result, true);
        f->r.plugin->deactivate(f->r.plugin);
        assert_int_equal(spy_live(), 0);
    }
}

/* A device whose answer to the self-test is wrong: whichever of the maps it is, the
 * method is not activated. */
static void wrong_answers_are_noticed(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, 1);
        uint32_t n = 1;
        for (;; n++) {
            spy_reset();
            spy_spoil(n);
            const sv_status status = fixture_activate(f);
            if (!spy_spoiled()) break;
            if (status != SV_ERR_SELF_TEST) fail_msg("method %d, read %u: status %d", method, n, status);
            assert_int_equal(spy_live(), 0);
        }
        f->r.plugin->deactivate(f->r.plugin);
        /* depth and status, of the frame's own self-test (method wall has none) and of the method's */
        assert_int_equal(n - 1, method == SV_METHOD_WALL ? 2 : 4);
    }
}

/* ---- memory ---- */

static void allocations(void **state) {
    fixture *f = *state;
    if (!heap_spy_works()) skip();
    spy_watch(f->r.entry);
    heap_spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, 1);
        for (uint32_t n = 1;; n++) {
            heap_spy_reset();
            heap_spy_fail(n);
            const sv_status status = fixture_activate(f);
            const bool failed = heap_spy_failed();
            heap_spy_fail(0);
            if (status == SV_OK) f->r.plugin->deactivate(f->r.plugin);
            if (!failed) break;
            fixture_refused(f, status, SV_ERR_NO_MEMORY, "no memory for ");
            assert_int_equal(fixture_begin(f), SV_ERR_STATE);
            assert_int_equal(spy_live(), 0);
            assert_int_equal(heap_spy_live(), 0);
        }
    }
}

static void create(void **state) {
    fixture *f = *state;
    if (!heap_spy_works()) skip();
    const sv_entry *entry = f->r.entry;
    heap_spy_watch(entry);
    const sv_plugin *out = f->r.plugin;
    for (uint32_t n = 1; n <= 3; n++) { /* the instance, its values, what is its own */
        heap_spy_fail(n);
        assert_int_equal(entry->create(&f->r.host, entry->descriptor(0)->id, &out), SV_ERR_NO_MEMORY);
        assert_true(heap_spy_failed());
        assert_null(out);
        assert_int_equal(heap_spy_live(), 0);
        assert_non_null(strstr(f->r.last_log, "create: no memory for an instance"));
    }
    assert_int_equal(entry->create(&f->r.host, entry->descriptor(0)->id, &out), SV_OK);
    assert_int_equal(heap_spy_live(), 3);
    out->destroy(out);
    assert_int_equal(heap_spy_live(), 0);
}

/* Without memory for the build log the error is still that of the build. */
static void build_log(void **state) {
    fixture *f = *state;
    if (!heap_spy_works()) skip();
    spy_watch(f->r.entry);
    heap_spy_watch(f->r.entry);
    shared_programs_options("-D__kernel=banana");
    heap_spy_fail(2); /* the first one is for timing events */
    const sv_status status = fixture_activate(f);
    assert_true(heap_spy_failed());
    shared_programs_options(NULL);
    fixture_refused(f, status, SV_ERR_BUILD, "the kernels do not build: CL_BUILD_PROGRAM_FAILURE (-11)");
    assert_int_equal(spy_live(), 0);
    assert_int_equal(heap_spy_live(), 0);
    fixture_works(f);
}

UNIT_MAIN_OF(NULL, NULL, FIXTURE_TEST(activations), FIXTURE_TEST(activate_with_wide_vectors),
             FIXTURE_TEST(frames), FIXTURE_TEST(a_lost_device), FIXTURE_TEST(outputs_and_timing),
             FIXTURE_TEST(stage_times_of_a_failing_query), FIXTURE_TEST(methods),
             FIXTURE_TEST(wrong_answers_are_noticed), FIXTURE_TEST(allocations), FIXTURE_TEST(create),
             FIXTURE_TEST(build_log))
