/* SPDX-License-Identifier: MIT */
#include "guarded/guard_line.h"

#include "base/cli.h"

#include <string.h>

#define LEAST_S 0.01
#define MOST_S  86400.0

const char hs_guard_line_help[] =
    "The guard (the plugin runs in a process of its own; whatever it does, the host goes on):\n"
    "  --guard               any plugin [every library but the host's own smartvis.so]\n"
    "  --no-guard            none\n"
    "  --guard-time S[,S]    seconds a call of a frame may take, and any other call [5,60]\n"
    "  --guard-memory MIB    memory that the plugin's process may take [4096]\n";

bool hs_guard_line_is(int option) {
    return option >= HS_OPT_GUARD && option <= HS_OPT_GUARD_MEMORY;
}

/* "FRAME" or "FRAME,SETUP" */
static bool take_time(const char *text, hs_guard_options *options, hs_error *err) {
    char frame[32];
    const size_t length = strcspn(text, ",");
    if (length >= sizeof frame)
        return hs_fail(err, HS_ERR_USAGE, "--guard-time: '%s' is not a number of seconds, or two", text);
    memcpy(frame, text, length);
    frame[length] = '\0';
    if (!hs_cli_number("--guard-time", frame, LEAST_S, MOST_S, &options->frame_s, err)) return false;
    return text[length] == '\0' ||
           hs_cli_number("--guard-time", text + length + 1, LEAST_S, MOST_S, &options->setup_s, err);
}

bool hs_guard_line_take(int option, const char *text, hs_guard_options *options, hs_error *err) {
    uint64_t mib;
    switch (option) {
    case HS_OPT_GUARD:
        options->choice = HS_GUARD_ON;
        return true;
    case HS_OPT_NO_GUARD:
        options->choice = HS_GUARD_OFF;
        return true;
    case HS_OPT_GUARD_TIME:
        return take_time(text, options, err);
    default:
        if (!hs_cli_integer("--guard-memory", text, 16, 1u << 20, &mib, err)) return false;
        options->memory_bytes = mib << 20;
        return true;
    }
}
