/* SPDX-License-Identifier: MIT */
#include "core/cli.h"

#include "core/text.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char hs_exit_codes_help[] =
    "Exit codes:\n"
    "  0  everything went well\n"
    "  1  a check the command was asked for did not hold\n"
    "  2  the command line is wrong: unknown option, value out of range\n"
    "  3  a volume, scene or library cannot be read, or is not valid\n"
    "  4  the plugin cannot be loaded, one of its calls failed, or its process ended (unless its file is\n"
    "     missing, the pictures are written, unclipped)\n"
    "  5  OpenCL: no device, a build that failed, a call that failed\n"
    "  6  a result cannot be written\n"
    "  7  host memory ran out\n";

bool hs_cli_number(const char *option, const char *text, double low, double high, double *out,
                   hs_error *err) {
    char *end = NULL;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || !isfinite(value))
        return hs_fail(err, HS_ERR_USAGE, "%s: '%s' is not a number", option, text);
    if (value < low || value > high)
        return hs_fail(err, HS_ERR_USAGE, "%s: %s is outside %g .. %g", option, text, low, high);
    *out = value;
    return true;
}

bool hs_cli_integer(const char *option, const char *text, uint64_t low, uint64_t high, uint64_t *out,
                    hs_error *err) {
    char *end = NULL;
    errno = 0;
    const unsigned long long value = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end != '\0')
        return hs_fail(err, HS_ERR_USAGE, "%s: '%s' is not a whole number", option, text);
    if (errno == ERANGE || value < low || value > high)
        return hs_fail(err, HS_ERR_USAGE, "%s: %s is outside %llu .. %llu", option, text,
                       (unsigned long long)low, (unsigned long long)high);
    *out = value;
    return true;
}

bool hs_cli_u32(const char *option, const char *text, uint32_t low, uint32_t high, uint32_t *out,
                hs_error *err) {
    uint64_t value;
    if (!hs_cli_integer(option, text, low, high, &value, err)) return false;
    *out = (uint32_t)value;
    return true;
}

bool hs_cli_numbers(const char *option, const char *text, const char *names, double low, double high,
                    uint32_t least, uint32_t most, double *out, hs_error *err) {
    uint32_t count = 1;
    for (const char *comma = text; (comma = strchr(comma, ',')) != NULL; comma++) count++;
    bool ok = count >= least && count <= most;
    const char *at = text;
    for (uint32_t i = 0; ok && i < count; i++) {
        char part[64];
        const size_t length = strcspn(at, ",");
        ok = length < sizeof part;
        (void)snprintf(part, sizeof part, "%.*s", (int)length, at);
        if (ok && !hs_cli_number(option, part, low, high, &out[i], err)) return false;
        at += length + (at[length] == ',');
    }
    return ok || hs_fail(err, HS_ERR_USAGE, "%s: '%s', expected %s", option, text, names);
}

bool hs_cli_select(const char *option, const char *text, const char *const *names, uint32_t count,
                   uint32_t *index, hs_error *err) {
    char known[128] = "";
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(text, names[i]) == 0) {
            *index = i;
            return true;
        }
        (void)strncat(known, i ? ", " : "", sizeof known - strlen(known) - 1);
        (void)strncat(known, names[i], sizeof known - strlen(known) - 1);
    }
    return hs_fail(err, HS_ERR_USAGE, "%s: '%s' is none of %s", option, text, known);
}

bool hs_cli_append(const char *option, const char *text, const char **list, uint32_t *count,
                   uint32_t capacity, hs_error *err) {
    if (*count >= capacity)
        return hs_fail(err, HS_ERR_USAGE, "%s: given more than %u times", option, capacity);
    list[(*count)++] = text;
    return true;
}

int hs_cli_fail(const char *command, const hs_error *err) {
    hs_print(stderr, "host_sim %s: %s\n", command, err->text);
    if (err->code == HS_ERR_USAGE) (void)fprintf(stderr, "Try 'host_sim %s --help'.\n", command);
    return (int)err->code;
}

int hs_cli_finish(const char *program, int code) {
    static bool told; /* it fails again with every flush */
    if (fflush(stdout) == 0 && ferror(stdout) == 0) return code;
    if (!told)
        (void)fprintf(stderr, "%s: the standard output cannot be written: %s\n", program, strerror(errno));
    told = true;
    return code == HS_OK ? HS_ERR_OUTPUT : code;
}

bool hs_cli_no_more(int argc, char **argv, int next, hs_error *err) {
    return next >= argc || hs_fail(err, HS_ERR_USAGE, "'%s': unexpected argument", argv[next]);
}
