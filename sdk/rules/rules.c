/* SPDX-License-Identifier: MIT */
#include "rules/rules.h"

#include "smartvis/author_method.h"

#include <stdarg.h>

enum { TRIED = 1, SEEN = 2, BOTH = 3 };

const rule rules[RULE_COUNT] = {
#define ROW(name, who, id, needs, what, mend) {id, what, mend, ((who)&TRIED) != 0, ((who)&SEEN) != 0},
    RULES(ROW)
#undef ROW
};

bool rule_is_hosts(rule_name name) {
    return name >= RULE_host_create;
}

void rule_tell(const rule_sink *to, rule_name name, const char *format, ...) {
    char text[400];
    va_list args;
    va_start(args, format);
    sva_print(text, sizeof text, format, args);
    va_end(args);
    to->broken(to->context, name, text);
}

/* Bytes of the UTF-8 character at `c`, 0 if there is none. */
static size_t character(const unsigned char *c) {
    const size_t bytes = c[0] < 0x80                   ? 1
                         : c[0] >= 0xc2 && c[0] < 0xe0 ? 2
                         : c[0] >= 0xe0 && c[0] < 0xf0 ? 3
                         : c[0] >= 0xf0 && c[0] < 0xf5 ? 4
                                                       : 0;
    for (size_t i = 1; i < bytes; i++)
        if ((c[i] & 0xc0) != 0x80) return 0;
    return bytes;
}

bool rule_is_text(const char *text, size_t max_bytes) {
    const unsigned char *c = (const unsigned char *)text;
    for (size_t used = 0; c[used];) {
        const size_t bytes = character(c + used);
        if (bytes == 0 || (bytes == 1 && (c[used] < 0x20 || c[used] == 0x7f))) return false;
        used += bytes;
        if (used > max_bytes) return false;
    }
    return true;
}
