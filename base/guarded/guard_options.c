/* SPDX-License-Identifier: MIT */
#include "guarded/guard_options.h"

#include "core/cli.h"
#include "core/paths.h"
#include "core/system.h"

#include <stdio.h>

static char program[SYS_PATH + 16];
static bool itself;

void hs_guard_set_program(const char *path) {
    itself = !path;
    (void)snprintf(program, sizeof program, "%s", path ? path : "");
}

const char *hs_guard_program(void) {
    if (itself) return NULL;
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

bool hs_guard_wanted(const hs_guard_options *options, const char *path) {
    /* Where the build and an installation put it. Other folders, those of the environment too, are not the
     * host's. */
    static const char *const own[] = {"smartvis", "../lib/smartvis/smartvis"};
    char name[64], beside[SYS_PATH];
    if (options->choice != HS_GUARD_AUTO) return options->choice == HS_GUARD_ON;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
        (void)snprintf(name, sizeof name, "%s%s", own[i], sys_library_ending);
        if (hs_path_beside_program(name, beside, sizeof beside) && sys_same_file(path, beside)) return false;
    }
    return true;
}

#define MIN_S 0.01
#define MAX_S 86400.0

bool hs_guard_take_time(void *guard_options, const char *text, hs_error *err) {
    hs_guard_options *const options = guard_options;
    double seconds[2] = {0, options->setup_s};
    if (!hs_cli_numbers("--guard-time", text, "S or S,S", MIN_S, MAX_S, 1, 2, seconds, err)) return false;
    options->frame_s = seconds[0];
    options->setup_s = seconds[1];
    return true;
}

bool hs_guard_take_memory(void *guard_options, const char *text, hs_error *err) {
    uint64_t mib = 0;
    if (!hs_cli_integer("--guard-memory", text, 16, 1u << 20, &mib, err)) return false;
    ((hs_guard_options *)guard_options)->memory_bytes = mib << 20;
    return true;
}
