/* SPDX-License-Identifier: MIT */
/* A run's results as text. */
#pragma once

#include "commands/run.h"

#include <stdio.h>

/* The facts and the table of times, shares and statistics, as in the thesis' Figure 5.21 and Table 5.4. */
void hs_run_print(const hs_run *run, FILE *out);
