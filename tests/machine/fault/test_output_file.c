/* SPDX-License-Identifier: MIT */
/* A result file while it is written: signals that end the program take the half file with them, and nothing
 * else. */
#include "base/output_file.h"

#include "guard/child.h"
#include "support/metaimage_files.h"

#include <dirent.h>
#include <signal.h>
#include <unistd.h>

/* How many names of the folder are temporary. */
static int count_temporary(void) {
    int temporary = 0;
    DIR *dir = opendir(files_path(""));
    for (const struct dirent *entry; dir && (entry = readdir(dir));)
        temporary += strstr(entry->d_name, ".tmp") != NULL;
    if (dir) (void)closedir(dir);
    return temporary;
}

/* Commits one file, leaves two open, and ends by the signal. */
static int interrupted(int channel, void *context) {
    hs_output_file outputs[3];
    hs_error err = {0};
    static const char *const names[] = {"whole", "half", "third"};
    for (int i = 0; i < 3; i++)
        if (!hs_output_open(&outputs[i], files_path(names[i]), &err) ||
            !hs_output_write(&outputs[i], "text", 4, &err))
            return 1;
    if (!hs_output_commit(&outputs[0], &err)) return 2;
    if (files_count() < 3 || count_temporary() != 2) return 3;
    (void)raise(*(const int *)context);
    return 4;
}

static void signals_remove_what_is_half_written(void **state) {
    static int signals[] = {SIGINT, SIGTERM, SIGHUP};
    const hs_child_limits none = {0};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        hs_child child;
        must(hs_child_fork(&child, &none, interrupted, &signals[i], &err));
        hs_child_wait_end(&child, 60);
        assert_int_equal(child.end.fate, HS_CHILD_CRASHED); /* by the signal, as without a handler */
        assert_int_equal(child.end.number, signals[i]);
        hs_child_close(&child);
        assert_int_equal(files_count(), 1);
        assert_int_equal(count_temporary(), 0);
        assert_int_equal(unlink(files_path("whole")), 0);
    }
}

/* nohup: what is ignored stays ignored. */
static int ignoring(int channel, void *context) {
    hs_output_file output;
    hs_error err = {0};
    (void)signal(SIGHUP, SIG_IGN);
    if (!hs_output_open(&output, files_path("half"), &err)) return 1;
    (void)raise(SIGHUP);
    return hs_output_commit(&output, &err) ? 0 : 2;
}

static void an_ignored_signal_is_none(void **state) {
    hs_child child;
    const hs_child_limits none = {0};
    must(hs_child_fork(&child, &none, ignoring, NULL, &err));
    hs_child_wait_end(&child, 60);
    assert_int_equal(child.end.fate, HS_CHILD_LEFT);
    assert_int_equal(child.end.number, 0);
    hs_child_close(&child);
    assert_int_equal(unlink(files_path("half")), 0);
    assert_int_equal(files_count(), 0);
}

UNIT_MAIN(files_setup, files_teardown, signals_remove_what_is_half_written, an_ignored_signal_is_none)
