/* SPDX-License-Identifier: MIT */
#include "commands/vol_line.h"

#include "base/cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char hs_vol_line_help[] =
    "  --vol KEY=VALUE,...  the geometry of Kretz files; what is not given fits the scene:\n"
    "                   pitch, start, axis (mm): samples, their start, and the sweep's axis, from the\n"
    "                   array's centre of curvature; theta, phi (degrees) from the first to the last line\n"
    "                   and plane; samples, lines, planes; skew 0 .. 0.9: uneven angles;\n"
    "                   descending 0 or 1; mirrored 0 or 1: to be read with --mirror\n";

hs_vol_spec hs_vol_line_defaults(void) {
    return (hs_vol_spec){.start = NAN, .axis = NAN};
}

static bool take(const char *key, const char *value, hs_vol_spec *s, hs_error *err) {
    const struct {
        const char *key;
        double low, high;
        double *number;
        uint32_t *count;
        bool *flag;
    } keys[] = {
        {"pitch", 0.01, 5.0, &s->pitch, NULL, NULL},     {"start", 0.0, 1000.0, &s->start, NULL, NULL},
        {"axis", -1000.0, 1000.0, &s->axis, NULL, NULL}, {"theta", 0.01, 179.0, &s->theta, NULL, NULL},
        {"phi", 0.01, 179.0, &s->phi, NULL, NULL},       {"skew", 0.0, 0.9, &s->skew, NULL, NULL},
        {"samples", 2, 2048, NULL, &s->samples, NULL},   {"lines", 2, 2048, NULL, &s->lines, NULL},
        {"planes", 2, 2048, NULL, &s->planes, NULL},     {"descending", 0, 1, NULL, NULL, &s->descending},
        {"mirrored", 0, 1, NULL, NULL, &s->mirrored},
    };
    char option[32], known[160] = "";
    (void)snprintf(option, sizeof option, "--vol %.20s", key);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        (void)strncat(known, i ? ", " : "", sizeof known - strlen(known) - 1);
        (void)strncat(known, keys[i].key, sizeof known - strlen(known) - 1);
        if (strcmp(key, keys[i].key) != 0) continue;
        if (keys[i].number)
            return hs_cli_number(option, value, keys[i].low, keys[i].high, keys[i].number, err);
        uint32_t count = 0;
        if (!hs_cli_u32(option, value, (uint32_t)keys[i].low, (uint32_t)keys[i].high, &count, err))
            return false;
        if (keys[i].count) *keys[i].count = count;
        if (keys[i].flag) *keys[i].flag = count == 1;
        return true;
    }
    return hs_fail(err, HS_ERR_USAGE, "--vol: '%.40s' is none of %s", key, known);
}

bool hs_vol_line_parse(const char *text, hs_vol_spec *spec, hs_error *err) {
    while (*text) {
        char pair[64];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof pair)
            return hs_fail(err, HS_ERR_USAGE, "--vol: '%.40s...', expected KEY=VALUE,KEY=VALUE", text);
        memcpy(pair, text, length);
        pair[length] = '\0';
        char *equals = strchr(pair, '=');
        if (!equals) return hs_fail(err, HS_ERR_USAGE, "--vol: '%s', expected KEY=VALUE", pair);
        *equals = '\0';
        if (!take(pair, equals + 1, spec, err)) return false;
        text += length + (text[length] == ',');
    }
    return true;
}
