/* SPDX-License-Identifier: MIT */
/* A result file while it is written: signals that end the program take the half file with them, and nothing
 * else. */
#include "core/output_file.h"

#include "support/files.h"

#include <dirent.h>
#include <signal.h>
#include <sys/wait.h>
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
static int interrupted(int number) {
    hs_output_file outputs[3];
    hs_error err = {0};
    static const char *const names[] = {"whole", "half", "third"};
    for (int i = 0; i < 3; i++)
        if (!hs_output_open(&outputs[i], files_path(names[i]), &err) ||
            !hs_output_write(&outputs[i], "text", 4, &err))
            return 1;
    if (!hs_output_commit(&outputs[0], &err)) return 2;
    if (files_count() < 3 || count_temporary() != 2) return 3;
    (void)raise(number);
    return 4;
}

/* How a process that does this work ends, as waitpid tells. */
static int status_of(int (*work)(int number), int number) {
    int status = -1;
    const pid_t child = fork();
    if (child == 0) _exit(work(number));
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

static void signals_remove_what_is_half_written(void **state) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
        assert_int_equal(status_of(interrupted, signals[i]), signals[i]); /* as without a handler */
        assert_int_equal(files_count(), 1);
        assert_int_equal(count_temporary(), 0);
        assert_int_equal(unlink(files_path("whole")), 0);
    }
}

/* nohup: what is ignored stays ignored. */
static int ignoring(int number) {
    hs_output_file output;
    hs_error err = {0};
    (void)signal(number, SIG_IGN);
    if (!hs_output_open(&output, files_path("half"), &err)) return 1;
    (void)raise(number);
    return hs_output_commit(&output, &err) ? 0 : 2;
}

static void an_ignored_signal_is_none(void **state) {
    assert_int_equal(status_of(ignoring, SIGHUP), 0);
    assert_int_equal(unlink(files_path("half")), 0);
    assert_int_equal(files_count(), 0);
}

UNIT_MAIN(files_setup, files_teardown, signals_remove_what_is_half_written, an_ignored_signal_is_none)
