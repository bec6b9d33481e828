/* SPDX-License-Identifier: MIT */
#include "print.h"

#include "validate/checks/check.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>

static const char *colour_of(v_verdict verdict) {
    static const char *const codes[] = {"\x1b[32m", "\x1b[33m", "\x1b[2m",
                                        "\x1b[31m", "\x1b[31m", "\x1b[31m"};
    return codes[verdict];
}

void v_print_finding(const v_finding *f, bool colour) {
    (void)printf("%s%-7s%s %-22s %6.1f s", colour ? colour_of(f->verdict) : "", v_verdict_name(f->verdict),
                 colour ? "\x1b[0m" : "", f->check->id, f->seconds);
    (void)printf(f->text[0] ? "  %s\n" : "\n", f->text);
    (void)fflush(stdout);
}

static size_t count_of(const v_finding *findings, size_t count, v_verdict verdict) {
    size_t n = 0;
    for (size_t i = 0; i < count; i++) n += findings[i].verdict == verdict;
    return n;
}

void v_print_summary(const v_options *options, const v_finding *findings, size_t count, bool colour) {
    double seconds = 0.0;
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        seconds += findings[i].seconds;
        bad += v_is_bad(findings[i].verdict);
    }
    (void)printf("\n%zu checks in %.0f s with level %u and seed %" PRIu64 ":", count, seconds,
                 (unsigned)options->level, options->seed);
    for (int v = V_PASS; v <= V_TIMEOUT; v++) {
        const size_t n = count_of(findings, count, (v_verdict)v);
        if (n > 0 || v == V_PASS) (void)printf(" %zu %s", n, v_verdict_name((v_verdict)v));
    }
    (void)printf("\n");
    if (bad > 0) (void)printf("\nWhat to mend (docs/validator.md says why):\n");
    for (size_t i = 0; i < count; i++) {
        const v_finding *f = &findings[i];
        if (!v_is_bad(f->verdict)) continue;
        (void)printf("  %s%s%s: %s\n      %s\n      %s\n", colour ? "\x1b[1m" : "", f->check->id,
                     colour ? "\x1b[0m" : "", f->check->what, f->text, f->check->mend);
    }
}

bool v_print_json(const v_options *options, const v_finding *findings, size_t count) {
    json_t *checks = json_array(), *counts = json_object();
    bool bad = false;
    for (size_t i = 0; i < count; i++) {
        const v_finding *f = &findings[i];
        bad |= v_is_bad(f->verdict);
        (void)json_array_append_new(checks,
                                    json_pack("{s:s, s:s, s:s, s:f, s:s, s:s}", "id", f->check->id, "verdict",
                                              v_verdict_name(f->verdict), "text", f->text, "seconds",
                                              f->seconds, "what", f->check->what, "mend", f->check->mend));
    }
    for (int v = V_PASS; v <= V_TIMEOUT; v++)
        (void)json_object_set_new(counts, v_verdict_name((v_verdict)v),
                                  json_integer((json_int_t)count_of(findings, count, (v_verdict)v)));
    json_t *all = json_pack("{s:s, s:s?, s:I, s:I, s:b, s:o, s:o}", "library", options->path, "plugin",
                            options->id, "seed", (json_int_t)options->seed, "level",
                            (json_int_t)options->level, "passed", !bad, "counts", counts, "checks", checks);
    const bool ok = all && json_dumpf(all, stdout, JSON_INDENT(2)) == 0 && printf("\n") > 0;
    json_decref(all);
    return ok;
}

void v_print_list(void) {
    for (size_t i = 0; i < v_check_count; i++) (void)printf("%-22s %s\n", v_checks[i].id, v_checks[i].what);
}
