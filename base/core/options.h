/* SPDX-License-Identifier: MIT */
/* A command line by one table: what an option is called, what it takes, where that goes, and its help. */
#pragma once

#include "core/error.h"

#include <stddef.h>

typedef enum {
    HS_OPTION_FLAG,   /* a bool becomes true */
    HS_OPTION_TEXT,   /* const char * */
    HS_OPTION_COUNT,  /* uint32_t in low .. high */
    HS_OPTION_NUMBER, /* double in low .. high */
    HS_OPTION_FLOAT,  /* float in low .. high */
    HS_OPTION_WHOLE,  /* uint64_t from low on */
    HS_OPTION_CHOICE, /* an enum or int32_t becomes low */
    HS_OPTION_TAKEN,  /* `take` reads it; `text` is NULL without a value */
    HS_OPTION_GROUP   /* no option: `name` is the heading of those that follow */
} hs_option_type;

typedef struct {
    const char *name;
    const char *value; /* what help calls it; NULL: the option has none */
    const char *help;  /* lines, with newlines between them */
    hs_option_type type;
    size_t at; /* the target's place in the options */
    double low, high;
    bool (*take)(void *target, const char *text, hs_error *err);
} hs_option;

/* Rows of a table, which the last one ends. */
#define HS_FLAG(name, at, help)                                                                              \
    { name, NULL, help, HS_OPTION_FLAG, at, 0, 0, NULL }
#define HS_TEXT(name, value, at, help)                                                                       \
    { name, value, help, HS_OPTION_TEXT, at, 0, 0, NULL }
#define HS_CHOICE(name, at, choice, help)                                                                    \
    { name, NULL, help, HS_OPTION_CHOICE, at, choice, 0, NULL }
#define HS_TAKEN(name, value, at, take, help)                                                                \
    { name, value, help, HS_OPTION_TAKEN, at, 0, 0, take }
#define HS_IN(type, name, value, at, l, h, help)                                                             \
    { name, value, help, HS_OPTION_##type, at, l, h, NULL }
#define HS_OPTIONS_GROUP(heading)                                                                            \
    { heading, NULL, NULL, HS_OPTION_GROUP, 0, 0, 0, NULL }
#define HS_OPTIONS_END                                                                                       \
    { NULL, NULL, NULL, HS_OPTION_GROUP, 0, 0, 0, NULL }

/* Reads a command line by a list that ends with a name of NULL, and knows --help, too: true with `wants_help`
 * as soon as it is asked for. *next is the index of the first argument that is no option. HS_ERR_USAGE names
 * option, value and what is allowed. */
bool hs_options_read(int argc, char **argv, const hs_option *known, void *options, int *next,
                     bool *wants_help, hs_error *err);

/* Prints the options' part of a help text, --help included. */
void hs_options_print(const hs_option *known);

/* The whole of a help text: usage, options, more, the exit codes, all of whole lines. Returns HS_OK. */
int hs_options_help(const char *usage, const hs_option *known, const char *more);
