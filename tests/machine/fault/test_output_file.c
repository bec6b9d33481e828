/* SPDX-License-Identifier: MIT */
/* A result file while it is written: signals that end the program take the half file with them, and nothing
 * else. */
#include "base/output_file.h"

#include "guard/child.h"
#include "support/unit.h"

#include <dirent.h>
#include <signal.h>
#include <unistd.h>

static char folder[] = "/tmp/test_output_file_XXXXXX";

static const char *in_folder(const char *name) {
    static char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* Names in the folder, and how many of them are temporary. */
static int count_files(int *temporary) {
    int files = 0;
    DIR *dir = opendir(folder);
    *temporary = 0;
    for (const struct dirent *entry; dir && (entry = readdir(dir));) {
        files += entry->d_name[0] != '.';
        *temporary += strstr(entry->d_name, ".tmp") != NULL;
    }
    if (dir) (void)closedir(dir);
    return files;
}

/* Commits one file, leaves two open, and ends by the signal. */
static int interrupted(int channel, void *context) {
    hs_output_file outputs[3];
    hs_error err = {0};
    static const char *const names[] = {"whole", "half", "third"};
    for (int i = 0; i < 3; i++)
        if (!hs_output_open(&outputs[i], in_folder(names[i]), &err) ||
            !hs_output_write(&outputs[i], "text", 4, &err))
            return 1;
    if (!hs_output_commit(&outputs[0], &err)) return 2;
    int temporary;
    if (count_files(&temporary) < 3 || temporary != 2) return 3;
    (void)raise(*(const int *)context);
    return 4;
}

static void signals_remove_what_is_half_written(void **state) {
    static int signals[] = {SIGINT, SIGTERM, SIGHUP};
    const hs_child_limits none = {0};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        hs_child child;
        hs_error err = {0};
        int temporary;
        assert_true(hs_child_fork(&child, &none, interrupted, &signals[i], &err));
        hs_child_wait_end(&child, 60);
        assert_int_equal(child.end.fate, HS_CHILD_CRASHED); /* by the signal, as without a handler */
        assert_int_equal(child.end.number, signals[i]);
        hs_child_close(&child);
        assert_int_equal(count_files(&temporary), 1);
        assert_int_equal(temporary, 0);
        assert_int_equal(unlink(in_folder("whole")), 0);
    }
}

/* nohup: what is ignored stays ignored. */
static int ignoring(int channel, void *context) {
    hs_output_file output;
    hs_error err = {0};
    (void)signal(SIGHUP, SIG_IGN);
    if (!hs_output_open(&output, in_folder("half"), &err)) return 1;
    (void)raise(SIGHUP);
    return hs_output_commit(&output, &err) ? 0 : 2;
}

static void an_ignored_signal_is_none(void **state) {
    hs_child child;
    hs_error err = {0};
    const hs_child_limits none = {0};
    assert_true(hs_child_fork(&child, &none, ignoring, NULL, &err));
    hs_child_wait_end(&child, 60);
    assert_int_equal(child.end.fate, HS_CHILD_LEFT);
    assert_int_equal(child.end.number, 0);
    hs_child_close(&child);
    assert_int_equal(unlink(in_folder("half")), 0);
}

static int set_up_folder(void **state) {
    return mkdtemp(folder) ? 0 : -1;
}
static int remove_folder(void **state) {
    return rmdir(folder);
}

UNIT_MAIN(set_up_folder, remove_folder, cmocka_unit_test(signals_remove_what_is_half_written),
          cmocka_unit_test(an_ignored_signal_is_none))
