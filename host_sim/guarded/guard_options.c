/* SPDX-License-Identifier: MIT */
#include "guarded/guard_options.h"

#include "plugin/loader.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char program[PATH_MAX + 16];

void hs_guard_set_program(const char *path) {
    (void)snprintf(program, sizeof program, "%s", path);
}

const char *hs_guard_program(void) {
    char self[PATH_MAX];
    if (program[0]) return program;
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    self[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(self, '/');
    if (slash) *slash = '\0';
    (void)snprintf(program, sizeof program, "%s/host_sim", slash ? self : ".");
    return program;
}

void hs_guard_defaults(hs_guard_options *options) {
    *options = (hs_guard_options){.choice = HS_GUARD_AUTO,
                                  .frame_s = 5,
                                  .setup_s = 60,
                                  .memory_bytes = UINT64_C(4096) << 20,
                                  .restarts = 3};
}

bool hs_guard_wanted(const hs_guard_options *options, const char *path) {
    char own[1024];
    struct stat a, b;
    if (options->choice != HS_GUARD_AUTO) return options->choice == HS_GUARD_ON;
    hs_plugin_default_path(own, sizeof own);
    return stat(path, &a) != 0 || stat(own, &b) != 0 || a.st_dev != b.st_dev || a.st_ino != b.st_ino;
}
