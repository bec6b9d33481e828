/* SPDX-License-Identifier: MIT */
/* The results as tables on standard output. */
#ifndef METHODS_PRINT_H
#define METHODS_PRINT_H

#include "bench/methods_report.h"

/* The head before the first row of its kind, then a line each as they come in. */
void methods_print_head(const char *what);
void methods_print_row(const methods_row *row);
void methods_print_truth(const methods_report *report);
void methods_print_fits(const methods_report *report);

#endif
