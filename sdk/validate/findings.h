/* SPDX-License-Identifier: MIT */
/* What a run of the validator found, and how it is said: lines for a person, JSON, or JUnit's XML. */
#ifndef V_FINDINGS_H
#define V_FINDINGS_H

#include "core/error.h"
#include "validate/checks/check.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    const char *path; /* of the library, absolute */
    const char *id;   /* of the plugin; NULL: the first */
    uint64_t seed;
    uint32_t level;
    double
        timeout_s; /* of a check before the first frame is known to come; five times that of one after it */
    bool verbose, in_process;
} v_options;

typedef struct {
    const v_check *check;
    v_verdict verdict;
    char text[1000]; /* printable */
    double seconds;
    bool on_device; /* the check had the OpenCL device */
} v_finding;

/* True for what makes the validation fail. */
bool v_is_bad(v_verdict verdict);

/* Ids and sentences of all checks. */
void v_print_list(void);

/* One line of a finding. */
void v_print_finding(const v_finding *f, bool colour);

/* How many passed, and what to mend. */
void v_print_summary(const v_options *options, const v_finding *findings, size_t count, bool colour);

/* Everything as one JSON object. False if it cannot be written. */
bool v_print_json(const v_options *options, const v_finding *findings, size_t count);

/* Everything as a file that CI systems read: a test case a check. HS_ERR_OUTPUT. */
bool v_write_junit(const char *path, const v_options *options, const v_finding *findings, size_t count,
                   hs_error *err);

#endif
