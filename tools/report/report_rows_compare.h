/* SPDX-License-Identifier: MIT */
/* The ranking of a comparison, for the terminal and the CSV file. */
#ifndef HS_REPORT_ROWS_COMPARE_H
#define HS_REPORT_ROWS_COMPARE_H

#include "eval/eval_compare.h"

#include <stdio.h>

/* To a terminal, a line a method in the order of the ranks. */
void hs_eval_compare_print(const hs_eval_comparison *x, FILE *out);

/* "compare.csv" in the comparison's folder, a row a method, case and seed. HS_ERR_OUTPUT names the path. */
bool hs_eval_compare_table(const hs_eval_comparison *x, hs_error *err);

#endif
