/* SPDX-License-Identifier: MIT */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

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
