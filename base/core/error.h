/* SPDX-License-Identifier: MIT */
/* Errors of the host simulator: the first one is kept, with the file, field and value it is about. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Exit codes of host_sim (README, "Exit codes"). The numbers are part of its interface. */
typedef enum {
    HS_OK = 0,
    HS_ERR_FAILED = 1, /* a check the command was asked for did not hold */
    HS_ERR_USAGE = 2,  /* the command line is wrong: unknown option, value out of range */
    HS_ERR_INPUT = 3,  /* a volume, scene or library cannot be read, or is not valid */
    HS_ERR_PLUGIN = 4, /* the plugin cannot be loaded, or one of its calls failed */
    HS_ERR_DEVICE = 5, /* OpenCL: no device, a build that failed, a call that failed */
    HS_ERR_OUTPUT = 6, /* a result cannot be written */
    HS_ERR_MEMORY = 7  /* host memory ran out */
} hs_code;

typedef struct {
    hs_code code;    /* HS_OK while nothing went wrong */
    char text[1024]; /* one line: what, where, which value */
} hs_error;

/* Records the error unless one is there already. Always returns false, so that a function can end with
 * `return hs_fail(err, HS_ERR_INPUT, "%s: DimSize is '%s', expected three numbers", path, value);` */
bool hs_fail(hs_error *err, hs_code code, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Zeroed memory for `count` things of `bytes` bytes each, which the caller frees. NULL: HS_ERR_MEMORY names
 * what it was for. */
void *hs_memory(size_t count, size_t bytes, const char *what, hs_error *err);

/* clang's analyser reads one file at a time: this tells it what the comment above promises. */
#ifdef __clang_analyzer__
#define hs_fail(...) ((void)hs_fail(__VA_ARGS__), false)
#endif
