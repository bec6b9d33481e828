/* SPDX-License-Identifier: MIT */
/*
 * The plugin's own allocations fail, one by one: of create, and of a failing build that needs memory for its
 * log; test_method_calls has those of activate. Not under AddressSanitizer, which owns the heap
 * (spy/heap_spy.h).
 */
#include "programs/shared_programs.h"
#include "support/fixture.h"
#include "support/unit.h"
#include "validate/spy/cl_spy.h"
#include "validate/spy/heap_spy.h"

static void need_the_heap(void) {
    if (heap_spy_works()) return;
    print_message("AddressSanitizer owns the heap: nothing to do here\n");
    skip();
}

static void create(void **state) {
    need_the_heap();
    fixture *f = *state;
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
    need_the_heap();
    fixture *f = *state;
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
    assert_int_equal(fixture_activate(f), SV_OK);
    fixture_frame_is_good(f);
}

UNIT_MAIN(NULL, NULL, FIXTURE_TEST(create), FIXTURE_TEST(build_log))
