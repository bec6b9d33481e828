/* SPDX-License-Identifier: MIT */
/* sv_validate: tries whether a plugin keeps the promises of smartvis_plugin.h. */
#include "base/cli.h"
#include "base/progress.h"
#include "print.h"
#include "smartvis_plugin.h"
#include "validate/checks/check.h"

#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_CHECKS = 128 };

static const char help[] =
    "Usage: sv_validate [options] PLUGIN.so\n"
    "Tries whether a plugin keeps the promises of smartvis_plugin.h. Every check runs in a process of its "
    "own.\n"
    "\n"
    "  --only ID        only this check; repeatable\n"
    "  --list           print the checks' ids, and what each of them shows\n"
    "  --id ID          which of the library's plugins [the first]\n"
    "  --seed N         of everything random; the same seed tries the same [0]\n"
    "  --level N        1 .. 10: how much is tried [5]\n"
    "  --timeout S      seconds for a check up to first-frame, a later one has five times as many [60]\n"
    "  --json           one JSON object instead of lines\n"
    "  --verbose        what the plugin logs and prints goes to standard error\n"
    "  --in-process     no processes: for a debugger. A crash ends the validator.\n"
    "  --help, --version\n"
    "\n"
    "A check comes to: pass; warn (holds, and could be better); skip (does not apply: the plugin does not "
    "say\n"
    "that it can do that, or an earlier check failed); fail; crash; timeout.\n"
    "The variable SMARTVIS_DEVICE (cpu, gpu) chooses the OpenCL device.\n"
    "\n"
    "Exit codes:\n"
    "  0  nothing failed\n"
    "  1  a check failed, crashed or ran out of time\n"
    "  2  the command line is wrong\n"
    "  3  the library cannot be read\n"
    "  6  the results cannot be written\n"
    "  7  a process or memory could not be had\n";

typedef struct {
    v_options run;
    const v_check *only[MOST_CHECKS];
    size_t only_count;
    bool json;
    char path[PATH_MAX];
} command;

static bool choose(command *c, const char *id, hs_error *err) {
    const v_check *check = v_check_find(id);
    if (!check) return hs_fail(err, HS_ERR_USAGE, "--only: there is no check '%s' (see --list)", id);
    if (c->only_count < MOST_CHECKS) c->only[c->only_count++] = check;
    return true;
}

/* A regular file that begins as a shared library does. */
static bool find_library(command *c, const char *path, hs_error *err) {
    struct stat info;
    char magic[4] = "";
    if (stat(path, &info) != 0)
        return hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode)) return hs_fail(err, HS_ERR_INPUT, "%s: not a file", path);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return hs_fail(err, HS_ERR_INPUT, "%s: cannot be read: %s", path, strerror(errno));
    const ssize_t got = read(file, magic, sizeof magic);
    (void)close(file);
    if (got != (ssize_t)sizeof magic || memcmp(magic,
                                               "\x7f"
                                               "ELF",
                                               sizeof magic) != 0)
        return hs_fail(err, HS_ERR_INPUT, "%s: not a shared library", path);
    if (!realpath(path, c->path)) return hs_fail(err, HS_ERR_INPUT, "%s: cannot be resolved", path);
    c->run.path = c->path;
    return true;
}

enum { ONLY = 1000, LIST, ID, SEED, LEVEL, TIMEOUT, JSON, VERBOSE, IN_PROCESS, HELP, VERSION };

/* One option. False with an error, or with *done if there is nothing left to do. */
static bool take(command *c, int option, bool *done, hs_error *err) {
    switch (option) {
    case ONLY:
        return choose(c, optarg, err);
    case ID:
        c->run.id = optarg;
        return true;
    case SEED:
        return hs_cli_integer("--seed", optarg, 0, INT64_MAX, &c->run.seed, err);
    case LEVEL:
        return hs_cli_u32("--level", optarg, 1, 10, &c->run.level, err);
    case TIMEOUT:
        return hs_cli_number("--timeout", optarg, 0.1, 86400.0, &c->run.timeout_s, err);
    case JSON:
        c->json = true;
        return true;
    case VERBOSE:
        c->run.verbose = true;
        return true;
    case IN_PROCESS:
        c->run.in_process = true;
        return true;
    default:
        *done = option != '?';
        if (option == LIST) v_print_list();
        if (option == HELP) (void)fputs(help, stdout);
        if (option == VERSION)
            (void)printf("sv_validate " V_VERSION ", plugin ABI %u.%u\n", SV_ABI_MAJOR, SV_ABI_MINOR);
        return *done ? false : hs_fail(err, HS_ERR_USAGE, "unknown option, or one without its value");
    }
}

static bool parse(command *c, int argc, char **argv, bool *done, hs_error *err) {
    static const struct option options[] = {{"only", required_argument, NULL, ONLY},
                                            {"list", no_argument, NULL, LIST},
                                            {"id", required_argument, NULL, ID},
                                            {"seed", required_argument, NULL, SEED},
                                            {"level", required_argument, NULL, LEVEL},
                                            {"timeout", required_argument, NULL, TIMEOUT},
                                            {"json", no_argument, NULL, JSON},
                                            {"verbose", no_argument, NULL, VERBOSE},
                                            {"in-process", no_argument, NULL, IN_PROCESS},
                                            {"help", no_argument, NULL, HELP},
                                            {"version", no_argument, NULL, VERSION},
                                            {NULL, 0, NULL, 0}};
    int option;
    while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
        if (!take(c, option, done, err)) return false;
    if (argc - optind != 1)
        return hs_fail(err, HS_ERR_USAGE,
                       argc == optind ? "no library given" : "more than one library given");
    return find_library(c, argv[optind], err);
}

/* Runs what was asked for. Returns the exit code. */
static int validate(const command *c, hs_error *err) {
    static v_finding findings[MOST_CHECKS];
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
        else if (!v_run_check(&c->run, check, &findings[i], err))
            return (int)err->code;
        bad |= v_is_bad(findings[i].verdict);
        if (c->json) continue;
        hs_progress_end(&progress);
        v_print_finding(&findings[i], colour);
        hs_progress_begin(&progress, "sv_validate", count);
    }
    hs_progress_end(&progress);
    if (!c->json) v_print_summary(&c->run, findings, count, colour);
    if ((c->json && !v_print_json(&c->run, findings, count)) || fflush(stdout) != 0 || ferror(stdout)) {
        (void)hs_fail(err, HS_ERR_OUTPUT, "standard output: cannot be written");
        return HS_ERR_OUTPUT;
    }
    return bad ? HS_ERR_FAILED : HS_OK;
}

int main(int argc, char **argv) {
    static command c;
    hs_error err = {0};
    bool done = false;
    c.run = (v_options){.level = 5, .timeout_s = 60.0};
    /* PoCL would otherwise swallow a plugin's division by zero. */
    (void)setenv("POCL_SIGFPE_HANDLER", "0", 0);
    int code = HS_OK;
    if (parse(&c, argc, argv, &done, &err))
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
