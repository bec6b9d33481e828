/* SPDX-License-Identifier: MIT */
/* What the subcommands share: numbers from the command line, error lines, output folders. */
#ifndef HS_CLI_H
#define HS_CLI_H

#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

/* The exit codes, for the end of every --help. */
extern const char hs_exit_codes_help[];

/* Parses a number in low .. high; HS_ERR_USAGE names option, text and range. */
bool hs_cli_number(const char *option, const char *text, double low, double high, double *out, hs_error *err);
bool hs_cli_integer(const char *option, const char *text, uint64_t low, uint64_t high, uint64_t *out,
                    hs_error *err);

/* Prints "host_sim <command>: <error>", and for HS_ERR_USAGE where help is. Returns the exit code. */
int hs_cli_fail(const char *command, const hs_error *err);

/* Fails if arguments are left after the options. */
bool hs_cli_no_more(int argc, char **argv, int next, hs_error *err);

/* Makes the folder (and its parents) and proves that a file can be written there.
 * HS_ERR_OUTPUT names the path. */
bool hs_cli_make_folder(const char *path, hs_error *err);

/* Writes "<folder>/<name>" to out; HS_ERR_OUTPUT if it is longer than `bytes`. */
bool hs_cli_join(const char *folder, const char *name, char *out, size_t bytes, hs_error *err);

/* The plugin beside the executable: "<folder of host_sim>/smartvis.so". */
void hs_cli_default_plugin(char *out, size_t bytes);

#endif
