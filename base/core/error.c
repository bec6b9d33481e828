/* SPDX-License-Identifier: MIT */
#include "core/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* In parentheses, so that the analyser's macro of this name leaves the definition alone. */
bool(hs_fail)(hs_error *err, hs_code code, const char *format, ...) {
    if (err->code != HS_OK) return false;
    err->code = code;
    va_list args;
    va_start(args, format);
    /* Clang 14 takes va_start for unknown where one process reads the file for a second target. */
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    (void)vsnprintf(err->text, sizeof err->text, format, args);
    va_end(args);
    return false;
}

void *hs_memory(size_t count, size_t bytes, const char *what, hs_error *err) {
    void *memory = calloc(count, bytes);
    if (!memory) (void)hs_fail(err, HS_ERR_MEMORY, "%s: no memory for %zu x %zu bytes", what, count, bytes);
    return memory;
}
