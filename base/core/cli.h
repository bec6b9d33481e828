/* SPDX-License-Identifier: MIT */
/* What command lines share: numbers, error lines, exit codes. */
#pragma once

#include "core/error.h"

#include <stdint.h>

/* The exit codes, for the end of every --help. */
extern const char hs_exit_codes_help[];

/* Parses a number in low .. high; HS_ERR_USAGE names option, text and range. */
bool hs_cli_number(const char *option, const char *text, double low, double high, double *out, hs_error *err);
bool hs_cli_integer(const char *option, const char *text, uint64_t low, uint64_t high, uint64_t *out,
                    hs_error *err);
bool hs_cli_u32(const char *option, const char *text, uint32_t low, uint32_t high, uint32_t *out,
                hs_error *err);

/* "A,B": `least` .. `most` numbers in low .. high, of which `names` tells what they are ("LOW,HIGH"). Only as
 * many of `out` are written. */
bool hs_cli_numbers(const char *option, const char *text, const char *names, double low, double high,
                    uint32_t least, uint32_t most, double *out, hs_error *err);

/* The index of `text` among `count` names; HS_ERR_USAGE lists them. */
bool hs_cli_select(const char *option, const char *text, const char *const *names, uint32_t count,
                   uint32_t *index, hs_error *err);

/* Adds the value of an option that may be given `capacity` times to a list with room for as many;
 * HS_ERR_USAGE beyond. */
bool hs_cli_append(const char *option, const char *text, const char **list, uint32_t *count,
                   uint32_t capacity, hs_error *err);

/* Prints "host_sim <command>: <error>", and for HS_ERR_USAGE where help is. Returns the exit code. */
int hs_cli_fail(const char *command, const hs_error *err);

/* At the end of a program: what was printed must have arrived. On a full disk it did not, and only the last
 * flush may tell. Returns `code`, or HS_ERR_OUTPUT instead of HS_OK behind a message to standard error, which
 * comes once. */
int hs_cli_finish(const char *program, int code);

/* Fails if arguments are left after the options. */
bool hs_cli_no_more(int argc, char **argv, int next, hs_error *err);
