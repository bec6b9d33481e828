/* SPDX-License-Identifier: MIT */
/*
 * What the reconstruction methods ask of OpenCL and of the heap: whichever of their calls fails, in activate
 * or in a frame, there is an error with a reason, nothing is left behind, and the next frame is good.
 */
#include "support/fixture.h"
#include "support/surfaces.h"
#include "support/unit.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

#include <math.h>

static const cl_int CODE = CL_OUT_OF_HOST_MEMORY;

/* A method, with or without the pre-filter, in one of the work layouts. */
static void choose(fixture *f, int method, bool prefilter, uint32_t strategy) {
    rig_format how = {.fixed = {{rig_param(&f->r, "method"), 0, method},
                                {rig_param(&f->r, "prefilter"), 0, prefilter},
                                {rig_param(&f->r, "strategy"), 0, strategy}}};
    fixture_change(f, how);
}

/* A whole frame with any point good enough. */
static sv_status frame(fixture *f) {
    const sv_plugin *p = f->r.plugin;
    const sv_param_value any = {rig_param(&f->r, "evidence"), 0, 0.0};
    const sv_frame begin = {.size = sizeof begin, .values = &any, .value_count = 1};
    sv_status status = p->begin(p, &begin);
    if (status == SV_OK) status = fixture_slabs(f);
    return status == SV_OK ? fixture_end(f) : status;
}

static void assert_good(fixture *f) {
    for (int i = 0; i < FIXTURE_RAYS; i++) f->out.depth[i] = NAN;
    assert_int_equal(frame(f), SV_OK);
    assert_int_equal(f->out.stats.outcome, SV_OK);
    assert_int_equal(f->out.stats.unfilled, 0);
    for (int i = 0; i < FIXTURE_RAYS; i++) assert_true(isfinite(f->out.depth[i]));
}

/* One activation whose nth call fails. False if it makes fewer calls. */
static bool activate_failing(fixture *f, uint32_t n) {
    spy_reset();
    spy_fail(n, CODE);
    const sv_status status = fixture_activate(f);
    const bool failed = spy_failed() != NULL;
    if (failed && status >= 0) fail_msg("call %u, %s: failed unnoticed", n, spy_failed());
    if (failed) assert_true(strlen(f->r.plugin->last_error(f->r.plugin)) > 0);
    spy_fail(0, 0);
    if (status == SV_OK) f->r.plugin->deactivate(f->r.plugin);
    if (spy_live() != 0) fail_msg("call %u: %d objects left", n, spy_live());
    return failed;
}

static void activations_fail(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, method == SV_METHOD_MEAN, 1);
        uint32_t n = 1;
        /* most calls are kernels, which are alike: further and further apart */
        while (activate_failing(f, n)) n += 3 + n / 16;
        assert_int_equal(fixture_activate(f), SV_OK);
        assert_good(f);
        f->r.plugin->deactivate(f->r.plugin);
        print_message("%s: activation of some %u calls\n", surface_name(method), n);
        assert_true(n > 100);
    }
}

static void frames_fail(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, method == SV_METHOD_MEAN, 2);
        assert_int_equal(fixture_activate(f), SV_OK);
        for (uint32_t n = 1;; n += 1 + n / 8) {
            spy_reset();
            spy_fail(n, CODE);
            const sv_status status = frame(f);
            const bool failed = spy_failed() != NULL;
            spy_fail(0, 0);
            if (!failed) break;
            if (status != SV_ERR_OPENCL) fail_msg("%s, call %u: status %d", surface_name(method), n, status);
            assert_true(strlen(f->r.plugin->last_error(f->r.plugin)) > 0);
            assert_good(f);
        }
        f->r.plugin->deactivate(f->r.plugin);
        assert_int_equal(spy_live(), 0);
    }
}

static void allocations_fail(void **state) {
    fixture *f = *state;
    if (!heap_spy_works()) skip();
    spy_watch(f->r.entry);
    heap_spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, method == SV_METHOD_MEAN, 1);
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

/* A device whose answer to the self-test is wrong: whichever of the maps it is, the
 * method is not activated. */
static void wrong_answers_are_noticed(void **state) {
    fixture *f = *state;
    spy_watch(f->r.entry);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method)) {
        choose(f, method, method == SV_METHOD_MEAN, 1);
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

UNIT_MAIN(NULL, NULL, FIXTURE_TEST(activations_fail), FIXTURE_TEST(wrong_answers_are_noticed),
          FIXTURE_TEST(frames_fail), FIXTURE_TEST(allocations_fail))
