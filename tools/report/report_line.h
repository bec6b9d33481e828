/* SPDX-License-Identifier: MIT */
/* The command line of `host_sim report`. */
#ifndef HS_REPORT_LINE_H
#define HS_REPORT_LINE_H

#include "base/error.h"
#include "eval/eval_study.h"

/* Reads the options, which point into argv. HS_ERR_USAGE names option, value and what is allowed. With
 * --help, *help is true and the rest is not read. */
bool hs_report_line_parse(int argc, char **argv, hs_eval_options *options, bool *help, hs_error *err);

/* Prints all options and the exit codes. */
void hs_report_line_help(void);

#endif
