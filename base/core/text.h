/* SPDX-License-Identifier: MIT */
/*
 * Text from outside (plugins, scene files, volumes, paths) on its way to a terminal. Control characters would
 * move its cursor, change its title or hide what was written, so they are shown as what they are: \x1b.
 */
#pragma once

#include <stddef.h>
#include <stdio.h>

/* Copies UTF-8 with everything else made visible: bytes that are no UTF-8, and control characters (C0,
 * DEL, C1), become "\xNN" byte by byte. A newline stays if `keep_newlines` is not 0. Always ends with a
 * NUL; what does not fit is left out, never half an escape or half a character. Returns `out`. */
char *hs_text_escape(char *out, size_t bytes, const char *text, int keep_newlines);

/* fprintf for lines with text from outside: formats, then escapes all but newlines. For colours of the host's
 * own use fprintf. A line longer than memory allows is left out. */
void hs_print(FILE *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
