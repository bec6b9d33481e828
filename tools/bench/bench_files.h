/* SPDX-License-Identifier: MIT */
/* The benchmark's results as CSV and JSON. */
#ifndef BENCH_FILES_H
#define BENCH_FILES_H

#include "bench/bench_results.h"

/* HS_ERR_OUTPUT names the path. */
bool bench_write_csv(const bench_report *report, const char *path, hs_error *err);
bool bench_write_json(const bench_report *report, const char *path, hs_error *err);

#endif
