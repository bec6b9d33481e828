/* SPDX-License-Identifier: MIT */
/* The table of two methods beside each other, for the terminal, the CSV file and the page alike. */
#ifndef HS_REPORT_ROWS_BESIDE_H
#define HS_REPORT_ROWS_BESIDE_H

#include "eval/eval_study.h"

#include <stdio.h>

#define HS_BESIDE_CELLS 14u
#define HS_BESIDE_CELL  48u /* bytes */

/* The table as cells of text: row 0 is the head, 1 .. count the cases, count + 1 the means. */
void hs_eval_beside_row(const hs_eval_study *study, uint32_t row, char cell[HS_BESIDE_CELLS][HS_BESIDE_CELL]);

/* To a terminal, and as "beside.csv" in the study's folder (HS_ERR_OUTPUT names the path). Nothing if there
 * is no other method. */
void hs_eval_beside_print(const hs_eval_study *study, FILE *out);
bool hs_eval_beside_table(const hs_eval_study *study, hs_error *err);

#endif
