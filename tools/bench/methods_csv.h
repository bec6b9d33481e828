/* SPDX-License-Identifier: MIT */
/* The results as CSV: a line a row; what is not known is empty. */
#ifndef METHODS_CSV_H
#define METHODS_CSV_H

#include "bench/methods_report.h"

/* HS_ERR_OUTPUT names the path. */
bool methods_write_csv(const methods_report *report, const char *path, hs_error *err);

#endif
