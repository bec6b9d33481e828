/* SPDX-License-Identifier: MIT */
/* Runs checks, each in a process of its own, and keeps what they found. */
#ifndef RUNNER_H
#define RUNNER_H

#include "base/error.h"
#include "validate/checks/check.h"

#include <stddef.h>

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
} v_finding;

/* Runs one check. False only if no process can be started. */
bool v_run_check(const v_options *options, const v_check *check, v_finding *out, hs_error *err);

/* The check that `check` needs and that did not pass, directly or through others; NULL: none among those that
 * were run. */
const v_check *v_blocked_by(const v_check *check, const v_finding *findings, size_t count);

/* Notes that a check was skipped because of another one. */
void v_skip_check(const v_check *check, const v_check *because, v_finding *out);

const char *v_verdict_name(v_verdict verdict);

/* True for what makes the validation fail. */
bool v_is_bad(v_verdict verdict);

#endif
