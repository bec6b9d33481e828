/* SPDX-License-Identifier: MIT */
/* What the command lines of the benchmarks share: the loop over the options, and options that both have. */
#ifndef BENCH_CLI_H
#define BENCH_CLI_H

#include "base/error.h"

#include <getopt.h>
#include <stdbool.h>
#include <stdint.h>

/* Voxels or pixels along an axis that --size chooses from. */
enum { BENCH_SIZES = 3 };
extern const uint32_t bench_sizes[BENCH_SIZES];

/* The value of --help in a list of options; those of others start behind it. */
enum { BENCH_OPT_HELP = 256, BENCH_OPT_FIRST };

/* Hands every option to `set`, its argument in optarg. True without `wants_help` when all were taken; true
 * with it as soon as help is asked for. HS_ERR_USAGE. */
typedef bool (*bench_set_option)(void *options, int option, hs_error *err);
bool bench_parse(int argc, char **argv, const struct option *known, bench_set_option set, void *options,
                 bool *wants_help, hs_error *err);

bool bench_parse_size(const char *text, bool chosen[BENCH_SIZES], hs_error *err);

/* What was not chosen is all chosen. Returns how many were. */
int bench_choose_all_if_none(bool *chosen, int count);

/* Finds out now, not after minutes, that a file cannot be written. NULL: none is wanted. HS_ERR_OUTPUT. */
bool bench_try_output(const char *path, hs_error *err);

/* Says on stderr what went wrong; returns the exit code. */
int bench_fail(const char *program, const hs_error *err);

#endif
