/* SPDX-License-Identifier: MIT */
#include "validate/findings.h"

#include "core/output_file.h"
#include "core/text.h"

#include <inttypes.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>

/* ---- checks */
/* The rules that the validator tries, in their order. */
#define ROW_TRIED(name, id, needs) {&rules[RULE_##name], id, needs, check_##name},
#define ROW_BOTH(name, id, needs)  ROW_TRIED(name, id, needs)
#define ROW_SEEN(name, id, needs)
#define ROW(name, who, id, needs, what, mend) ROW_##who(name, id, needs)
const v_check v_checks[] = {RULES(ROW)};
const size_t v_check_count = sizeof v_checks / sizeof *v_checks;

const v_check *v_check_find(const char *id) {
    for (size_t i = 0; i < v_check_count; i++)
        if (strcmp(v_checks[i].id, id) == 0) return &v_checks[i];
    return NULL;
}

/* ---- what they found */
static const char *v_verdict_name(v_verdict verdict) {
    static const char *const names[] = {"pass", "warn", "skip", "fail", "crash", "timeout"};
    return names[verdict];
}

bool v_is_bad(v_verdict verdict) {
    return verdict == V_FAIL || verdict == V_CRASH || verdict == V_TIMEOUT;
}

static const char *colour_of(v_verdict verdict) {
    static const char *const codes[] = {"\x1b[32m", "\x1b[33m", "\x1b[2m",
                                        "\x1b[31m", "\x1b[31m", "\x1b[31m"};
    return codes[verdict];
}

/* What to do about it. A call that does not come back says nothing of the rule that was tried. */
static const char *mend(const v_finding *f) {
    return f->verdict == V_TIMEOUT
               ? "Look for a loop or a wait in that call or kernel whose end these values or voxels put off."
               : f->check->rule->mend;
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
                     colour ? "\x1b[0m" : "", f->check->rule->what, f->text, mend(f));
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
                                              f->seconds, "what", f->check->rule->what, "mend", mend(f)));
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
    for (size_t i = 0; i < v_check_count; i++)
        (void)printf("%-22s %s\n", v_checks[i].id, v_checks[i].rule->what);
}

/* Texts of a finding are printable: what is left to escape is XML's own. */
static void print_xml(FILE *out, const char *text) {
    for (; *text; text++) {
        const char *entity = *text == '&'   ? "&amp;"
                             : *text == '<' ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '"' ? "&quot;"
                                            : NULL;
        if (entity)
            (void)fputs(entity, out);
        else
            (void)fputc(*text, out);
    }
}

/* A path may hold bytes that are no characters of XML. */
static void print_xml_path(FILE *out, const char *path) {
    char text[PATH_MAX];
    print_xml(out, hs_text_escape(text, sizeof text, path, 0));
}

/* A crash and a timeout are JUnit's errors. A warning passes, and stands in the case's output. */
static void print_case(FILE *out, const v_finding *f) {
    static const char *const elements[] = {NULL, "system-out", "skipped", "failure", "error", "error"};
    const char *element = elements[f->verdict];
    (void)fprintf(out, "  <testcase classname=\"sv_validate\" name=\"%s\" time=\"%.3f\">", f->check->id,
                  f->seconds);
    if (element && f->verdict == V_WARN) {
        (void)fprintf(out, "<%s>warning: ", element);
        print_xml(out, f->text);
        (void)fprintf(out, "</%s>", element);
    } else if (element) {
        (void)fprintf(out, "<%s type=\"%s\" message=\"", element, v_verdict_name(f->verdict));
        print_xml(out, f->text);
        (void)fprintf(out, "\">");
        if (v_is_bad(f->verdict)) {
            print_xml(out, f->check->rule->what);
            (void)fprintf(out, "\n");
            print_xml(out, mend(f));
        }
        (void)fprintf(out, "</%s>", element);
    }
    (void)fprintf(out, "</testcase>\n");
}

bool v_write_junit(const char *path, const v_options *options, const v_finding *findings, size_t count,
                   hs_error *err) {
    hs_output_file output;
    double seconds = 0.0;
    if (!hs_output_open(&output, path, err)) return false;
    FILE *out = output.file;
    for (size_t i = 0; i < count; i++) seconds += findings[i].seconds;
    (void)fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"sv_validate ");
    print_xml_path(out, options->path);
    (void)fprintf(out, "\" tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" skipped=\"%zu\" time=\"%.3f\">\n",
                  count, count_of(findings, count, V_FAIL),
                  count_of(findings, count, V_CRASH) + count_of(findings, count, V_TIMEOUT),
                  count_of(findings, count, V_SKIP), seconds);
    for (size_t i = 0; i < count; i++) print_case(out, &findings[i]);
    (void)fprintf(out, "</testsuite>\n");
    return hs_output_commit(&output, err);
}
