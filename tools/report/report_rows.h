/* SPDX-License-Identifier: MIT */
/* Tables 5.2 and 5.3 as cells of text, for the terminal, the CSV files and the page alike. */
#ifndef HS_REPORT_ROWS_H
#define HS_REPORT_ROWS_H

#include "eval/eval_study.h"

#include <stdio.h>

#define HS_EVAL_CELLS 13u /* columns */
#define HS_EVAL_CELL  32u /* bytes of a cell */

typedef struct {
    char cell[HS_EVAL_CELLS][HS_EVAL_CELL];
} hs_eval_row;

typedef enum {
    HS_TABLE_BEST,  /* Table 5.2: each case's best setting */
    HS_TABLE_COMMON /* Table 5.3: the common threshold and kernel, each case's best knob */
} hs_eval_table_kind;

/* The columns' names; those that begin with "thesis" come from it. */
const char *const *hs_eval_row_head(const hs_eval_study *study);

/* Row `index` of the table; index == study->count: the average over the cases. */
void hs_eval_row_make(const hs_eval_study *study, hs_eval_table_kind kind, uint32_t index, hs_eval_row *row);

/* One sentence: what the table shows. */
void hs_eval_row_caption(const hs_eval_study *study, hs_eval_table_kind kind, char *out, size_t bytes);

/* Both tables, and that of two methods beside each other, to a terminal. */
void hs_eval_study_print(const hs_eval_study *study, FILE *out);

/* The same as "best.csv", "common.csv" and "beside.csv" in the study's folder.
 * HS_ERR_OUTPUT names the file. */
bool hs_eval_study_tables(const hs_eval_study *study, hs_error *err);

#endif
