/* SPDX-License-Identifier: MIT */
/* Which programs are compiled without optimisation (smartvis/author_programs.h). */
#include "support/programs_fixture.h"

/* A process that is in a hurry, or not; either way it has the right program. */
static void builds_quickly(const char *options, bool quick) {
    sva_built built = build(text, options);
    assert_int_equal(built.quick, quick);
    assert_int_equal(optimised, !quick);
    assert_int_equal(answer_of(built.program), 42);
    (void)clReleaseProgram(built.program);
}

/* PoCL asked for the name when it began, so only the marks lie in this folder. */
static const char *begin_quick(const char *name) {
    const char *folder = begin(name);
    assert_int_equal(setenv("SMARTVIS_KERNEL_CACHE", "", 1), 0);
    assert_int_equal(setenv("POCL_CACHE_DIR", folder, 1), 0);
    assert_int_equal(setenv("SMARTVIS_QUICK_KERNELS", "1", 1), 0);
    assert_int_equal(mkdir(folder, 0700), 0);
    told_version = "OpenCL 3.0 PoCL 3.1";
    return unit_text("%s/smartvis", folder);
}

static void end_quick(const char *cache) {
    assert_int_equal(unsetenv("SMARTVIS_QUICK_KERNELS"), 0);
    assert_int_equal(cache ? setenv("POCL_CACHE_DIR", cache, 1) : unsetenv("POCL_CACHE_DIR"), 0);
}

static void who_is_in_a_hurry(void **state) {
    const char *cache = getenv("POCL_CACHE_DIR"), *was = cache ? unit_text("%s", cache) : NULL;
    const char *marks = begin_quick("hurry");
    builds_quickly("-DNUMBER=40", true);
    builds_quickly("-DNUMBER=40", true); /* it was never optimised */
    assert_int_equal(access(marks, F_OK), -1);
    assert_int_equal(setenv("SMARTVIS_QUICK_KERNELS", "", 1), 0);
    builds_quickly("-DNUMBER=40", false);
    assert_int_equal(setenv("SMARTVIS_QUICK_KERNELS", "1", 1), 0);
    builds_quickly("-DNUMBER=40", false); /* and is there now */
    builds_quickly("-DNUMBER=40 -DANOTHER", true);
    told_driver = "of another year";
    builds_quickly("-DNUMBER=40", true);
    told_driver = NULL;
    const char *const others[] = {"OpenCL 3.0 PoCL 6.0", "OpenCL 2.1 LINUX"};
    for (int i = 0; i < 2; i++) {
        told_version = others[i];
        builds_quickly("-DNUMBER=40 -DANOTHER", false);
    }
    assert_int_equal(unlink(file_in(marks, NULL)), 0); /* there is one: those have none */
    told_version = "OpenCL 3.0 PoCL 3.1";
    builds_quickly("-DNUMBER=40", true);
    assert_int_equal(rmdir(marks), 0);
    end_quick(was);
}

/* Then a program is compiled once more, and that is all. */
static void where_no_mark_can_be(void **state) {
    const char *cache = getenv("POCL_CACHE_DIR"), *was = cache ? unit_text("%s", cache) : NULL;
    const char *marks = begin_quick("unmarked");
    files_write("unmarked/smartvis", "", NULL, 0);
    assert_int_equal(setenv("SMARTVIS_QUICK_KERNELS", "", 1), 0);
    builds_quickly("-DNUMBER=40", false);
    assert_int_equal(setenv("SMARTVIS_QUICK_KERNELS", "1", 1), 0);
    builds_quickly("-DNUMBER=40", true);
    assert_int_equal(unlink(marks), 0);
    end_quick(was);
}

UNIT_MAIN(setup, teardown, who_is_in_a_hurry, where_no_mark_can_be)
