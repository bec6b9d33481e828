/* SPDX-License-Identifier: MIT */
#include "core/options.h"

#include "core/cli.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

enum { MAX_OPTIONS = 64, HELP = 256, FIRST };

static bool take(const hs_option *o, void *options, const char *text, hs_error *err) {
    void *const target = (char *)options + o->at;
    char name[32];
    double number = 0.0;
    (void)snprintf(name, sizeof name, "--%s", o->name);
    switch (o->type) {
    case HS_OPTION_FLAG:
        return *(bool *)target = true;
    case HS_OPTION_TEXT:
        *(const char **)target = text;
        return true;
    case HS_OPTION_COUNT:
        return hs_cli_u32(name, text, (uint32_t)o->low, (uint32_t)o->high, target, err);
    case HS_OPTION_NUMBER:
        return hs_cli_number(name, text, o->low, o->high, target, err);
    case HS_OPTION_FLOAT:
        if (!hs_cli_number(name, text, o->low, o->high, &number, err)) return false;
        *(float *)target = (float)number;
        return true;
    case HS_OPTION_WHOLE:
        return hs_cli_integer(name, text, (uint64_t)o->low, UINT64_MAX, target, err);
    case HS_OPTION_CHOICE:
        *(int *)target = (int)o->low;
        return true;
    case HS_OPTION_TAKEN:
        return o->take(target, text, err);
    case HS_OPTION_GROUP:
        break;
    }
    return hs_fail(err, HS_ERR_FAILED, "%s: an option of no type", name);
}

bool hs_options_read(int argc, char **argv, const hs_option *known, void *options, int *next,
                     bool *wants_help, hs_error *err) {
    struct option list[MAX_OPTIONS + 2] = {{"help", no_argument, NULL, HELP}};
    for (int i = 0, n = 1; known[i].name; i++) {
        if (known[i].type == HS_OPTION_GROUP) continue;
        if (n > MAX_OPTIONS)
            return hs_fail(err, HS_ERR_FAILED, "--%s: there are too many options", known[i].name);
        list[n++] =
            (struct option){known[i].name, known[i].value ? required_argument : no_argument, NULL, FIRST + i};
    }
    *wants_help = false;
    optind = 1;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", list, NULL)) != -1;) {
        if (option == ':' || option == '?')
            return hs_fail(err, HS_ERR_USAGE, "%s: %s", argv[optind - 1],
                           option == ':' ? "needs a value" : "not an option of this command");
        if (option == HELP) return *wants_help = true;
        if (!take(&known[option - FIRST], options, optarg, err)) return false;
    }
    *next = optind;
    return true;
}

void hs_options_print(const hs_option *known) {
    enum { COLUMN = 24 };
    for (; known->name; known++) {
        if (known->type == HS_OPTION_GROUP) {
            printf("%s\n", known->name);
            continue;
        }
        int indent = COLUMN - printf("  --%s%s%s", known->name, known->value ? " " : "",
                                     known->value ? known->value : "");
        for (const char *line = known->help; line; line = strchr(line, '\n')) {
            line += *line == '\n';
            printf("%*s%.*s\n", indent > 0 ? indent : 2, "", (int)strcspn(line, "\n"), line);
            indent = COLUMN;
        }
    }
    printf("  --help                this text\n");
}

int hs_options_help(const char *usage, const hs_option *known, const char *more) {
    printf("%s", usage);
    hs_options_print(known);
    printf("\n%s%s", more, hs_exit_codes_help);
    return HS_OK;
}
