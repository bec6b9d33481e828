/* SPDX-License-Identifier: MIT */
#include "bench/bench_cli.h"

#include "base/cli.h"
#include "base/output_file.h"

#include <stdio.h>
#include <string.h>

const uint32_t bench_sizes[BENCH_SIZES] = {128, 171, 512};

bool bench_parse(int argc, char **argv, const struct option *known, bench_set_option set, void *options,
                 bool *wants_help, hs_error *err) {
    *wants_help = false;
    for (int c; (c = getopt_long(argc, argv, "", known, NULL)) != -1;) {
        if (c == BENCH_OPT_HELP) return *wants_help = true;
        /* of an unknown one getopt_long has said what is wrong */
        if (c < BENCH_OPT_FIRST) return hs_fail(err, HS_ERR_USAGE, "the command line is wrong");
        if (!set(options, c, err)) return false;
    }
    return hs_cli_no_more(argc, argv, optind, err);
}

bool bench_parse_size(const char *text, bool chosen[BENCH_SIZES], hs_error *err) {
    for (int i = 0; i < BENCH_SIZES; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "%u", bench_sizes[i]);
        if (strcmp(text, name) == 0) return chosen[i] = true;
    }
    return hs_fail(err, HS_ERR_USAGE, "--size: %s is none of 128, 171, 512", text);
}

int bench_choose_all_if_none(bool *chosen, int count) {
    int found = 0;
    for (int i = 0; i < count; i++) found += chosen[i];
    for (int i = 0; i < count; i++) chosen[i] = chosen[i] || found == 0;
    return found;
}

bool bench_try_output(const char *path, hs_error *err) {
    hs_output_file output = {0};
    if (path && !hs_output_open(&output, path, err)) return false;
    hs_output_discard(&output);
    return true;
}

int bench_fail(const char *program, const hs_error *err) {
    (void)fprintf(stderr, "%s: %s\n", program, err->text);
    if (err->code == HS_ERR_USAGE) (void)fprintf(stderr, "Try '%s --help'.\n", program);
    return (int)err->code;
}
