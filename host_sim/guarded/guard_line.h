/* SPDX-License-Identifier: MIT */
/* The guard on a command line: --guard, --no-guard, --guard-time, --guard-memory. */
#ifndef HS_GUARD_LINE_H
#define HS_GUARD_LINE_H

#include "guarded/guard_options.h"

#include <getopt.h>

/* Values of struct option.val for the commands' own tables. */
enum { HS_OPT_GUARD = 1024, HS_OPT_NO_GUARD, HS_OPT_GUARD_TIME, HS_OPT_GUARD_MEMORY };

/* Lines of such a table. */
#define HS_GUARD_OPTIONS                                                                                     \
    {"guard", no_argument, NULL, HS_OPT_GUARD}, {"no-guard", no_argument, NULL, HS_OPT_NO_GUARD},            \
        {"guard-time", required_argument, NULL, HS_OPT_GUARD_TIME}, {                                        \
        "guard-memory", required_argument, NULL, HS_OPT_GUARD_MEMORY                                         \
    }

/* What --help says of them, indented as all options are. */
extern const char hs_guard_line_help[];

/* True if the option is one of these. */
bool hs_guard_line_is(int option);

/* Takes one of them; `text` is its value. HS_ERR_USAGE. */
bool hs_guard_line_take(int option, const char *text, hs_guard_options *options, hs_error *err);

#endif
