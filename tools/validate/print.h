/* SPDX-License-Identifier: MIT */
/* What the validator says: lines for a person, or JSON. */
#ifndef PRINT_H
#define PRINT_H

#include "runner.h"

/* One line of a finding. */
void v_print_finding(const v_finding *finding, bool colour);

/* How many passed, and what to mend. */
void v_print_summary(const v_options *options, const v_finding *findings, size_t count, bool colour);

/* Everything as one JSON object. False if it cannot be written. */
bool v_print_json(const v_options *options, const v_finding *findings, size_t count);

/* Ids and sentences of all checks. */
void v_print_list(void);

#endif
