/* SPDX-License-Identifier: MIT */
/* Command lines of any bytes: an argument a line of the input, read as `run` and as `report` read theirs.
 * Nothing is run. */
#include "commands/run_line.h"
#include "fuzz/fuzz_target.h"
#include "report/report.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_ARGS = 200 };

/* getopt keeps a place within an argument of the line before, which is gone by now. */
static void forget_line(void) {
    char name[] = "fuzz";
    char *none[] = {name, NULL};
    optind = 0;
    (void)getopt(1, none, "");
}

static void check_run(int argc, char **argv) {
    hs_run_line line;
    hs_error err = {0};
    forget_line();
    if (!hs_run_line_parse(argc, argv, &line, &err)) {
        FUZZ_HOLDS(err.code == HS_ERR_USAGE && err.text[0]);
    } else if (!line.help) {
        const hs_run_request *r = &line.request;
        FUZZ_HOLDS(line.out &&
                   (r->scene.name || (r->volume_count > 0 && r->volume_count <= HS_RUN_MAX_VOLUMES)));
        FUZZ_HOLDS(r->set_count <= HS_RUN_MAX_SETS && r->loop.frames > 0 && r->loop.slab_slices > 0);
        FUZZ_HOLDS(r->loop.yaw >= -360 && r->loop.yaw <= 360); /* no NaN either */
    }
}

static void check_report(int argc, char **argv) {
    hs_eval_options options;
    hs_error err = {0};
    bool help = false;
    forget_line();
    if (!hs_report_line_parse(argc, argv, &options, &help, &err))
        FUZZ_HOLDS(err.code == HS_ERR_USAGE && err.text[0]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1), *argv[MAX_ARGS + 2], *copy[MAX_ARGS + 2], *next = NULL;
    if (!text) abort();
    memcpy(text, data, size);
    text[size] = '\0';
    char name[] = "fuzz";
    int argc = 0;
    argv[argc++] = name;
    for (char *arg = strtok_r(text, "\n", &next); arg && argc <= MAX_ARGS; arg = strtok_r(NULL, "\n", &next))
        argv[argc++] = arg;
    argv[argc] = NULL;
    memcpy(copy, argv, sizeof argv[0] * (size_t)(argc + 1)); /* getopt sorts them */
    check_run(argc, argv);
    check_report(argc, copy);
    free(text);
    return 0;
}
