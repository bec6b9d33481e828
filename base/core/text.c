/* SPDX-License-Identifier: MIT */
#include "core/text.h"

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
    va_list args;
    char *line = NULL;
    va_start(args, format);
    const int length = vasprintf(&line, format, args);
    va_end(args);
    if (length < 0) return; /* and line means nothing */
    const size_t bytes = (size_t)length * ESCAPE_BYTES + 1;
    char *shown = malloc(bytes);
    if (shown) (void)fputs(hs_text_escape(shown, bytes, line, 1), out);
    free(shown);
    free(line);
}
