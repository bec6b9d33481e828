/* SPDX-License-Identifier: MIT */
/* The command line of `host_sim run`. */
#pragma once

#include "commands/run.h"

#define HS_RUN_MAX_VOLUMES 1024u
#define HS_RUN_MAX_SETS    64u

/* The command line as read. The request points into it, so it must not move. */
typedef struct {
    hs_run_request request;
    const char *volumes[HS_RUN_MAX_VOLUMES];
    const char *sets[HS_RUN_MAX_SETS];
    hs_mark marks[HS_MARKS_MAX];
    const char *out, *json;
    hs_look look;
    float exposure;     /* 0: as suits the look */
    char scanned[1024]; /* --scanned's first path */
    bool carrier_given, padding_given, help;
} hs_run_line;

/* Reads the options. HS_ERR_USAGE names option, value and what is allowed. Nothing is read after --help. */
bool hs_run_line_parse(int argc, char **argv, hs_run_line *line, hs_error *err);

/* Prints all options and the exit codes; HS_OK. */
int hs_run_line_help(void);
