/* SPDX-License-Identifier: MIT */
/* sv_validate: tries whether a plugin keeps the promises of smartvis_plugin.h. It runs checks, each in a
 * process of its own. */
#include "core/cli.h"
#include "core/error.h"
#include "core/options.h"
#include "core/output_file.h"
#include "core/progress.h"
#include "core/system.h"
#include "core/text.h"
#include "guard/child.h"
#include "smartvis_plugin.h"
#include "sv_version.h"
#include "validate/drive/process.h"
#include "validate/findings.h"

#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* -------------------------------------------------------------------------------------- running checks -- */
/* Runs checks, each in a process of its own, and keeps what they found. */

/* Less than a machine has, more than a compiler needs. */
#define MEMORY_BYTES (1536ull << 20)
#define PATIENCE     5.0
/* Of that time for a check, what a kernel may take, and a call of a frame. */
#define FRAME_SHARE (1.0 / 6.0)

/* The text of a finding quotes the plugin: a terminal must not obey it. */
static void keep_text(v_finding *out, const char *format, const char *first, const char *second) {
    char text[sizeof out->text];
    (void)snprintf(text, sizeof text, format, first, second);
    (void)hs_text_escape(out->text, sizeof out->text, text, 0);
}

/* ---- in the check's process */
/* In memory that is shared with it. */
typedef struct {
    size_t check; /* of v_checks */
    bool watched; /* the process is looked at around every call */
    v_report report;
} job;

static void perform(const v_options *options, job *j) {
    static v_run run;
    const v_check *check = &v_checks[j->check];
    run = (v_run){.path = options->path,
                  .id = options->id,
                  .seed = options->seed,
                  .level = options->level,
                  .verbose = options->verbose,
                  .report = &j->report,
                  .watch = j->watched ? v_watch_begin() : NULL};
    v_random_begin(&run, check->id);
    if (!setjmp(run.escape)) {
        check->run(&run);
        v_rig_close(run.rig);
        v_memory_end();
        v_where(&run, "the end of the check");
    }
    spy_tell_work(NULL, NULL);
    j->report.finished = true;
}

/* No plugin is judged by what its caller or the validator left open. */
static _Noreturn void perform_in_child(const v_options *options, job *j) {
    sys_close_others();
    perform(options, j);
    hs_child_leave(0);
}

static job *map_job(intptr_t shared) {
    job *j = sys_shared_map(shared, sizeof *j, true);
    return j && sys_shared_use(j, sizeof *j, true) ? j : NULL;
}

/* ---- in the validator */
static void report_accident(const hs_child_end *end, const v_report *report, v_finding *out) {
    char how[100], where[sizeof *report];
    const bool runs = atomic_load(&report->opencl.since_ns) > 0;
    const int line = (int)strnlen(report->line, sizeof report->line);
    const int values = (int)strnlen(report->values, sizeof report->values);
    hs_child_tell(end, how, sizeof how);
    (void)snprintf(where, sizeof where, "%.*s%s%.*s%s%.*s%s%.*s%s", (int)sizeof report->where,
                   report->where[0] ? report->where : "the check itself", runs ? "; running: kernel " : "",
                   runs ? (int)sizeof report->opencl.name : 0, report->opencl.name,
                   values ? "; values of the frame: " : "", values, report->values,
                   line ? "; last line of its log: \"" : "", line, report->line, line ? "\"" : "");
    out->verdict = end->fate == HS_CHILD_LATE ? V_TIMEOUT : V_CRASH;
    /* Whose code died: a check names each call of the plugin before it makes it. */
    keep_text(out, report->where[0] ? "%s; under way: %s" : "%s; sv_validate's own, under way: %s", how,
              where);
}

/* A call of a frame or a kernel under way, in what it may take and has taken longer. */
typedef struct {
    const v_report *report;
    double allowed;
} frame_watch;

/* Since when a call of a frame computes by itself: until frames are known to come, OpenCL may compile for it.
 * 0: it does not. */
static uint64_t computes_since(const v_report *report) {
    const uint64_t since = atomic_load(&report->since_ns);
    if (since == 0 || atomic_load(&report->warm)) return since;
    if (atomic_load(&report->opencl.busy) > 0) return 0;
    const uint64_t idle = atomic_load(&report->opencl.idle_ns);
    return idle > since ? idle : since;
}

static double is_late(const void *watch) {
    const frame_watch *w = watch;
    const uint64_t call = computes_since(w->report);
    const uint64_t kernel = atomic_load(&w->report->opencl.since_ns);
    const double least = hs_now() - w->allowed;
    const bool late = (call && (double)call * 1e-9 < least) || (kernel && (double)kernel * 1e-9 < least);
    return late ? w->allowed : 0.0;
}

static bool run_in_child(const v_options *options, intptr_t shared, const job *j, v_finding *out,
                         hs_error *err) {
    const hs_child_limits limits = {.memory_bytes = MEMORY_BYTES,
                                    .output = options->verbose ? HS_CHILD_SHOWN : HS_CHILD_DISCARDED};
    hs_child child;
    if (!hs_child_again(&child, &limits, &shared, 1, err)) return false;
    const frame_watch watch = {&j->report, options->timeout_s * FRAME_SHARE};
    hs_child_wait_watched(&child, options->timeout_s * (j->report.warm ? PATIENCE : 1.0), is_late, &watch);
    if (!j->report.finished) report_accident(&child.end, &j->report, out);
    hs_child_close(&child);
    return true;
}

/* What a plugin does to the process is told by a check of its own. If that finds nothing, the later ones
 * look, too: they make calls that it does not make. */
static bool v_is_watched(const v_options *options, const v_check *check, const v_finding *findings,
                         size_t count) {
    const v_check *own = v_check_find("process-untouched");
    for (size_t i = 0; i < count; i++)
        if (findings[i].check == own && v_is_bad(findings[i].verdict)) return false;
    return check > own && !options->in_process;
}

/* Runs one check. False only if no process can be started. */
static bool v_run_check(const v_options *options, const v_check *check, bool watched, v_finding *out,
                        hs_error *err) {
    const double start = hs_now();
    bool ok = true;
    *out = (v_finding){.check = check};
    const intptr_t shared = sys_shared_new(sizeof(job));
    job *j = map_job(shared);
    if (!j) return hs_fail(err, HS_ERR_MEMORY, "no memory for a check's report");
    *j = (job){.check = (size_t)(check - v_checks), .watched = watched};
    j->report.warm = check->needs && strcmp(check->needs, "first-frame") == 0;
    if (options->in_process)
        perform(options, j);
    else
        ok = run_in_child(options, shared, j, out, err);
    if (ok && j->report.finished) {
        j->report.text[sizeof j->report.text - 1] = '\0';
        out->verdict = j->report.verdict <= V_FAIL ? j->report.verdict : V_FAIL;
        out->on_device = j->report.on_device;
        if (j->report.no_device) ok = hs_fail(err, HS_ERR_DEVICE, "%s: %s", check->id, j->report.text);
        keep_text(out, "%s%s", j->report.text, "");
    }
    out->seconds = hs_now() - start;
    sys_shared_unmap(j, sizeof *j);
    sys_shared_close(shared);
    return ok;
}

/* The check that `check` needs and that did not pass, directly or through others; NULL: none among those that
 * were run. */
static const v_check *v_blocked_by(const v_check *check, const v_finding *findings, size_t count) {
    for (size_t i = 0; check->needs && i < count; i++) {
        if (strcmp(findings[i].check->id, check->needs) != 0) continue;
        if (v_is_bad(findings[i].verdict)) return findings[i].check;
        return v_blocked_by(findings[i].check, findings, count);
    }
    return NULL;
}

/* Notes that a check was skipped because of another one. */
static void v_skip_check(const v_check *check, const v_check *because, v_finding *out) {
    *out = (v_finding){.check = check, .verdict = V_SKIP};
    keep_text(out, "%s did not pass%s", because->id, "");
}

/* ---------------------------------------------------------------------------------------- command line -- */
/* sv_validate: tries whether a plugin keeps the promises of smartvis_plugin.h. */

enum { MAX_CHECKS = 128 };

typedef struct {
    v_options run;
    const v_check *only[MAX_CHECKS];
    size_t only_count;
    bool json, list, version;
    const char *junit;
    char path[SYS_PATH];
} command;

static bool take_only(void *all, const char *ids, hs_error *err) {
    command *const c = all;
    for (const char *at = ids; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        char id[64];
        (void)snprintf(id, sizeof id, "%.*s", (int)strcspn(at, ","), at);
        const v_check *check = v_check_find(id);
        if (!check) return hs_fail(err, HS_ERR_USAGE, "--only: there is no check '%s' (see --list)", id);
        if (c->only_count < MAX_CHECKS) c->only[c->only_count++] = check;
    }
    return true;
}

/* What this process may not open would be told as the plugin's fault. */
static bool may_open_files(hs_error *err) {
    enum { NEEDED = 64 };
    return v_process_most_files() >= NEEDED ||
           hs_fail(err, HS_ERR_MEMORY, "this process may open %" PRIu64 " files (ulimit -n), %d are needed",
                   v_process_most_files(), NEEDED);
}

/* A regular file that begins as a shared library does. */
static bool find_library(command *c, const char *path, hs_error *err) {
    char magic[4] = "";
    const size_t wanted = strlen(library_magic);
    if (!sys_is_there(path))
        return hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    if (!sys_is_file(path)) return hs_fail(err, HS_ERR_INPUT, "%s: not a file", path);
    const int file = sys_open(path, SYS_READ);
    if (file < 0) return hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    const ptrdiff_t got = sys_read_at(file, magic, wanted, 0);
    (void)close(file);
    if (got != (ptrdiff_t)wanted || memcmp(magic, library_magic, wanted) != 0)
        return hs_fail(err, HS_ERR_INPUT, "%s: not a shared library", path);
    char *whole = sys_full_path(path);
    (void)snprintf(c->path, sizeof c->path, "%s", whole ? whole : "");
    free(whole);
    if (!c->path[0]) return hs_fail(err, HS_ERR_INPUT, "%s: cannot be resolved", path);
    c->run.path = c->path;
    return true;
}

/* JSON's whole numbers have a sign. */
static bool take_seed(void *all, const char *text, hs_error *err) {
    return hs_cli_integer("--seed", text, 0, INT64_MAX, &((command *)all)->run.seed, err);
}

#define AT(field) offsetof(command, field)
static const hs_option options[] = {
    HS_TAKEN("only", "ID[,ID]", 0, take_only, "only these checks; repeatable"),
    HS_FLAG("list", AT(list), "print the checks' ids, and what each of them shows"),
    HS_TEXT("id", "ID", AT(run.id), "which of the library's plugins [the first]"),
    HS_TAKEN("seed", "N", 0, take_seed, "of everything random; the same seed tries the same [0]"),
    HS_IN(COUNT, "level", "N", AT(run.level), 1, 10, "1 .. 10: how much is tried [5]"),
    HS_IN(NUMBER, "timeout", "S", AT(run.timeout_s), 0.1, 86400,
          "seconds for a check up to first-frame; a later one has five times as many, and a sixth for a "
          "kernel, and for a call of a frame [60]"),
    HS_FLAG("json", AT(json), "one JSON object instead of lines"),
    HS_TEXT("junit", "FILE", AT(junit), "everything as JUnit's XML, too, for CI systems"),
    HS_FLAG("verbose", AT(run.verbose), "what the plugin logs and prints goes to standard error"),
    HS_FLAG("in-process", AT(run.in_process), "no processes: for a debugger. A crash ends the validator."),
    HS_FLAG("version", AT(version), "versions of this program and of the ABI"),
    HS_OPTIONS_END,
};

static void print_help(void) {
    printf("Usage: sv_validate [options] PLUGIN\n"
           "Tries whether a plugin keeps the promises of smartvis_plugin.h. Every check runs in a process of "
           "its own.\n"
           "\n");
    hs_options_print(options);
    printf("\n"
           "A check comes to: pass; warn (holds, and could be better); skip (does not apply: the plugin does "
           "not say\n"
           "that it can do that, or an earlier check failed); fail; crash; timeout.\n"
           "The variable SMARTVIS_DEVICE (cpu, gpu) narrows the choice of the OpenCL device.\n"
           "\n"
           "Exit codes:\n"
           "  0  nothing failed\n"
           "  1  a check failed, crashed or ran out of time\n"
           "  2  the command line is wrong\n"
           "  3  the library cannot be read\n"
           "  5  a check needs an OpenCL device, and there is none\n"
           "  6  the results cannot be written\n"
           "  7  a process or memory could not be had\n");
}

/* False with an error, or with *done if there is nothing left to do. */
static bool parse(command *c, int argc, char **argv, bool *done, hs_error *err) {
    int next = argc;
    bool help = false;
    if (!hs_options_read(argc, argv, options, c, &next, &help, err)) return false;
    *done = help || c->list || c->version;
    if (help)
        print_help();
    else if (c->list)
        v_print_list();
    else if (c->version)
        printf("sv_validate " SV_VERSION ", plugin ABI %u.%u\n", SV_ABI_MAJOR, SV_ABI_MINOR);
    if (*done) return false;
    if (argc - next != 1)
        return hs_fail(err, HS_ERR_USAGE, argc == next ? "no library given" : "more than one library given");
    return hs_output_try(c->junit, err) && may_open_files(err) && find_library(c, argv[next], err);
}

/* False if checks had a device, and it refused what every one of them asked of it. */
static bool device_worked(const v_finding *findings, size_t count, hs_error *err) {
    const v_finding *refused = NULL;
    for (size_t i = 0; i < count; i++) {
        if (!findings[i].on_device) continue;
        if (findings[i].verdict != V_SKIP) return true;
        refused = &findings[i];
    }
    if (!refused) return true;
    return hs_fail(err, HS_ERR_DEVICE, "no check could use the OpenCL device: %s: %s", refused->check->id,
                   refused->text);
}

/* Runs what was asked for. Returns the exit code. */
static int validate(const command *c, hs_error *err) {
    static v_finding findings[MAX_CHECKS];
    const size_t count = c->only_count ? c->only_count : v_check_count;
    const bool colour = !c->json && hs_use_colour(STDOUT_FILENO);
    bool bad = false;
    hs_progress progress;
    hs_progress_begin(&progress, "sv_validate", count);
    for (size_t i = 0; i < count; i++) {
        const v_check *check = c->only_count ? c->only[i] : &v_checks[i];
        const v_check *blocker = v_blocked_by(check, findings, i);
        hs_progress_step(&progress, i);
        if (blocker)
            v_skip_check(check, blocker, &findings[i]);
        else if (!v_run_check(&c->run, check, v_is_watched(&c->run, check, findings, i), &findings[i], err))
            return (int)err->code;
        bad |= v_is_bad(findings[i].verdict);
        if (c->json) continue;
        hs_progress_end(&progress);
        v_print_finding(&findings[i], colour);
        hs_progress_begin(&progress, "sv_validate", count);
    }
    hs_progress_end(&progress);
    if (c->junit && !v_write_junit(c->junit, &c->run, findings, count, err)) return (int)err->code;
    if (!c->json) v_print_summary(&c->run, findings, count, colour);
    if ((c->json && !v_print_json(&c->run, findings, count)) || fflush(stdout) != 0 || ferror(stdout)) {
        (void)hs_fail(err, HS_ERR_OUTPUT, "standard output: cannot be written");
        return bad ? HS_ERR_FAILED : HS_ERR_OUTPUT; /* what was found is not hidden */
    }
    if (bad) return HS_ERR_FAILED;
    return device_worked(findings, count, err) ? HS_OK : (int)err->code;
}

int main(int argc, char **argv) {
    static command c;
    hs_error err = {0};
    bool done = false;
    c.run = (v_options){.level = 5, .timeout_s = 60.0};
    argv = sys_arguments(&argc, argv);
    job *j = hs_child_take(&argc, argv) ? map_job(hs_child_passed(1)) : NULL;
    if (!j) sys_close_others();
    /* PoCL would otherwise swallow a plugin's division by zero. */
    sys_set_default("POCL_SIGFPE_HANDLER", "0");
    int code = HS_OK;
    const bool ready = parse(&c, argc, argv, &done, &err);
    if (ready && j && j->check < v_check_count) perform_in_child(&c.run, j);
    if (ready)
        code = validate(&c, &err);
    else if (!done)
        code = (int)err.code;
    if (err.code != HS_OK) {
        (void)fprintf(stderr, "sv_validate: %s\n", err.text);
        if (err.code == HS_ERR_USAGE) (void)fprintf(stderr, "Try 'sv_validate --help'.\n");
    }
    if (done && (fflush(stdout) != 0 || ferror(stdout))) code = HS_ERR_OUTPUT;
    return code;
}
