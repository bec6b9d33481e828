/* SPDX-License-Identifier: MIT */
#include "base/text.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { ESCAPE_BYTES = 4 }; /* "\xNN" */

/* Bytes of the UTF-8 character at `text` (RFC 3629: shortest form, no surrogates, up to U+10FFFF), or 0 if it
 * is none or a control character. */
static size_t visible(const unsigned char *text) {
    const unsigned char a = text[0];
    if (a < 0x80) return a >= 0x20 && a != 0x7f;
    const unsigned char b = text[1];
    if (a >= 0xc2 && a <= 0xdf)
        return b >= (a == 0xc2 ? 0xa0 : 0x80) && b <= 0xbf ? 2 : 0; /* below U+00A0: C1 */
    if ((b & 0xc0) != 0x80 || (text[2] & 0xc0) != 0x80) return 0;
    if (a == 0xe0) return b >= 0xa0 ? 3 : 0;
    if (a == 0xed) return b <= 0x9f ? 3 : 0;
    if (a >= 0xe1 && a <= 0xef) return 3;
    if ((text[3] & 0xc0) != 0x80) return 0;
    if (a == 0xf0) return b >= 0x90 ? 4 : 0;
    if (a == 0xf4) return b <= 0x8f ? 4 : 0;
    return a >= 0xf1 && a <= 0xf3 ? 4 : 0;
}

char *hs_text_escape(char *out, size_t bytes, const char *text, int keep_newlines) {
    static const char digits[] = "0123456789abcdef";
    const unsigned char *from = (const unsigned char *)text;
    size_t used = 0;
    while (*from) {
        const size_t length = *from == '\n' && keep_newlines ? 1 : visible(from);
        const size_t needed = length ? length : ESCAPE_BYTES;
        if (used + needed >= bytes) break;
        if (length) {
            memcpy(out + used, from, length);
        } else {
            const char escape[ESCAPE_BYTES] = {'\\', 'x', digits[*from >> 4], digits[*from & 15]};
            memcpy(out + used, escape, sizeof escape);
        }
        used += needed;
        from += length ? length : 1;
    }
    if (bytes) out[used] = '\0';
    return out;
}

void hs_print(FILE *out, const char *format, ...) {
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    const int length = vsnprintf(NULL, 0, format, args);
    const size_t bytes = length < 0 ? 0 : (size_t)length + 1;
    char *line = bytes ? malloc(bytes + bytes * ESCAPE_BYTES) : NULL;
    if (line) {
        (void)vsnprintf(line, bytes, format, again);
        (void)fputs(hs_text_escape(line + bytes, bytes * ESCAPE_BYTES, line, 1), out);
    }
    free(line);
    va_end(again);
    va_end(args);
}
