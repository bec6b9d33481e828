/* SPDX-License-Identifier: MIT */
#include "runner.h"

#include "base/progress.h"
#include "base/text.h"
#include "guard/child.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Less than a machine has, more than a compiler needs. */
#define MEMORY_BYTES (1536ull << 20)
#define PATIENCE     5.0

const char *v_verdict_name(v_verdict verdict) {
    static const char *const names[] = {"pass", "warn", "skip", "fail", "crash", "timeout"};
    return names[verdict];
}

bool v_is_bad(v_verdict verdict) {
    return verdict == V_FAIL || verdict == V_CRASH || verdict == V_TIMEOUT;
}

/* The text of a finding quotes the plugin: a terminal must not obey it. */
static void keep_text(v_finding *out, const char *format, const char *first, const char *second) {
    char text[sizeof out->text];
    (void)snprintf(text, sizeof text, format, first, second);
    (void)hs_text_escape(out->text, sizeof out->text, text, 0);
}

/* ---- in the check's process */
typedef struct {
    const v_options *options;
    const v_check *check;
    v_report *report;
} job;

static void perform(const job *j) {
    static v_run run;
    run = (v_run){.path = j->options->path,
                  .id = j->options->id,
                  .seed = j->options->seed,
                  .level = j->options->level,
                  .verbose = j->options->verbose,
                  .report = j->report};
    v_random_begin(&run, j->check->id);
    if (!setjmp(run.escape)) j->check->run(&run);
    j->report->finished = true;
}

static int perform_in_child(int channel, void *context) {
    const job *j = context;
    (void)channel;
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere >= 0) (void)dup2(nowhere, STDOUT_FILENO);
    if (nowhere >= 0 && !j->options->verbose) (void)dup2(nowhere, STDERR_FILENO);
    perform(j);
    return 0;
}

/* ---- in the validator */
static void tell_accident(const hs_child_end *end, const v_report *report, v_finding *out) {
    char how[100];
    hs_child_tell(end, how, sizeof how);
    out->verdict = end->fate == HS_CHILD_LATE ? V_TIMEOUT : V_CRASH;
    keep_text(out, "%s; under way: %s", how, report->where[0] ? report->where : "the check itself");
}

static bool run_in_child(const job *j, v_finding *out, hs_error *err) {
    const hs_child_limits limits = {.memory_bytes = MEMORY_BYTES};
    const bool late = j->check->needs && strcmp(j->check->needs, "first-frame") == 0;
    hs_child child;
    if (!hs_child_fork(&child, &limits, perform_in_child, (void *)(uintptr_t)j, err)) return false;
    hs_child_wait_end(&child, j->options->timeout_s * (late ? PATIENCE : 1.0));
    if (!j->report->finished) tell_accident(&child.end, j->report, out);
    hs_child_close(&child);
    return true;
}

bool v_run_check(const v_options *options, const v_check *check, v_finding *out, hs_error *err) {
    const double start = hs_now();
    bool ok = true;
    *out = (v_finding){.check = check};
    v_report *report = mmap(NULL, sizeof *report, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (report == MAP_FAILED) return hs_fail(err, HS_ERR_MEMORY, "no memory for a check's report");
    const job j = {options, check, report};
    if (options->in_process)
        perform(&j);
    else
        ok = run_in_child(&j, out, err);
    if (ok && report->finished) {
        report->text[sizeof report->text - 1] = '\0';
        out->verdict = report->verdict <= V_FAIL ? report->verdict : V_FAIL;
        keep_text(out, "%s%s", report->text, "");
    }
    out->seconds = hs_now() - start;
    (void)munmap(report, sizeof *report);
    return ok;
}

const v_check *v_blocked_by(const v_check *check, const v_finding *findings, size_t count) {
    for (size_t i = 0; check->needs && i < count; i++) {
        if (strcmp(findings[i].check->id, check->needs) != 0) continue;
        if (v_is_bad(findings[i].verdict)) return findings[i].check;
        return v_blocked_by(findings[i].check, findings, count);
    }
    return NULL;
}

void v_skip_check(const v_check *check, const v_check *because, v_finding *out) {
    *out = (v_finding){.check = check, .verdict = V_SKIP};
    keep_text(out, "%s did not pass%s", because->id, "");
}
