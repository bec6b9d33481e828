/* SPDX-License-Identifier: MIT */
/* What host_sim does not do on Windows: each says so. */
#include "console/console.h"
#include "core/cli.h"
#include "report/report.h"

static int refuse(const char *command) {
    hs_error err = {0};
    (void)hs_fail(&err, HS_ERR_USAGE, "not on Windows; it runs on Linux");
    return hs_cli_fail(command, &err);
}

int hs_cmd_console(int argc, char **argv) {
    (void)argc;
    (void)argv;
    return refuse("console");
}

int hs_cmd_demo(int argc, char **argv) {
    (void)argc;
    (void)argv;
    return refuse("demo");
}
