/* SPDX-License-Identifier: MIT */
/* Results of a parameter space as CSV files, one row per setting (docs/evaluation.md lists the columns). A
 * run that was ended goes on from them, and shards are put together by them. */
#ifndef HS_SPACE_CSV_H
#define HS_SPACE_CSV_H

#include "base/progress.h"
#include "eval/eval_study.h"

/* Reads every "space_<case>*.csv" of the folder. A last line that is cut off does not count. HS_ERR_INPUT: a
 * file of another identity, or a line that is no result, named with its number. */
bool hs_eval_csv_load(hs_eval_space *space, const char *folder, hs_error *err);

/*
 * Runs what the shard has to run and no file in `folder` holds yet. Results go to
 * "space_<case>.part<i>of<n>.csv" as they come, so that a run that was ended goes on where it stopped; once a
 * case is whole, to "space_<case>.csv". `progress` may be NULL. HS_ERR_OUTPUT names the file that cannot be
 * written; the others are those of hs_eval_csv_load and hs_eval_case_measure.
 */
bool hs_eval_csv_run(hs_eval_space *space, hs_eval_case *c, const char *folder, hs_eval_shard shard,
                     hs_progress *progress, hs_error *err);

#endif
