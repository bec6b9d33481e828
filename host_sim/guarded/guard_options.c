/* SPDX-License-Identifier: MIT */
#include "guarded/guard_options.h"

#include "base/paths.h"

#include <limits.h>
#include <stdio.h>
#include <sys/stat.h>

static char program[PATH_MAX + 16];

void hs_guard_set_program(const char *path) {
    (void)snprintf(program, sizeof program, "%s", path);
}

const char *hs_guard_program(void) {
    if (program[0] == '\0' && !hs_path_beside_program("host_sim", program, sizeof program))
        (void)snprintf(program, sizeof program, "./host_sim");
    return program;
}

void hs_guard_defaults(hs_guard_options *options) {
    *options = (hs_guard_options){.choice = HS_GUARD_AUTO,
                                  .frame_s = 5,
                                  .setup_s = 60,
                                  .memory_bytes = UINT64_C(4096) << 20,
                                  .restarts = 3};
}

/* True if both are there and are one file. */
static bool same_file(const char *a, const char *b) {
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

bool hs_guard_wanted(const hs_guard_options *options, const char *path) {
    /* Where the build and an installation put it. Other folders, those of the environment too, are not the
     * host's. */
    static const char *const own[] = {"smartvis.so", "../lib/smartvis/smartvis.so"};
    char beside[PATH_MAX];
    if (options->choice != HS_GUARD_AUTO) return options->choice == HS_GUARD_ON;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (hs_path_beside_program(own[i], beside, sizeof beside) && same_file(path, beside)) return false;
    return true;
}
