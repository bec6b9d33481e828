/* SPDX-License-Identifier: MIT */
#include "console/console_access.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

bool hs_console_make_token(char token[HS_CONSOLE_TOKEN], hs_error *err) {
    uint8_t bytes[(HS_CONSOLE_TOKEN - 1) / 2];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return hs_fail(err, HS_ERR_FAILED, "console: the system gives no random numbers");
    for (size_t i = 0; i < sizeof bytes; i++) (void)snprintf(token + 2 * i, 3, "%02x", bytes[i]);
    return true;
}

bool hs_console_token_fits(const char *query, const char *token) {
    const size_t length = strlen(token);
    const char *given = query;
    while (given && strncmp(given, "t=", 2) != 0) {
        given = strchr(given, '&');
        if (given) given++;
    }
    if (!given || strcspn(given + 2, "&") != length || length == 0) return false;
    unsigned differs = 0;
    for (size_t i = 0; i < length; i++) differs |= (unsigned char)given[2 + i] ^ (unsigned char)token[i];
    return differs == 0;
}

/* "1.2.3.4", four numbers up to 255. */
static bool is_ipv4(const char *text, size_t length) {
    unsigned parts = 0;
    for (size_t at = 0; at < length; parts++) {
        unsigned value = 0;
        size_t digits = 0;
        for (; at < length && text[at] >= '0' && text[at] <= '9' && digits < 4; at++, digits++)
            value = value * 10 + (unsigned)(text[at] - '0');
        if (digits == 0 || digits > 3 || value > 255) return false;
        if (at < length && (text[at] != '.' || at + 1 == length)) return false;
        at++;
    }
    return parts == 4;
}

/* "[...]" of hexadecimal digits and colons. */
static bool is_ipv6(const char *text, size_t length) {
    if (length < 4 || text[0] != '[' || text[length - 1] != ']') return false;
    for (size_t i = 1; i + 1 < length; i++)
        if (!strchr("0123456789abcdefABCDEF:.", text[i])) return false;
    return true;
}

static bool is_word(const char *text, size_t length, const char *word) {
    return strlen(word) == length && strncmp(text, word, length) == 0;
}

bool hs_console_host_is_ours(const char *host, uint32_t port, bool loopback) {
    if (!host) return false;
    const char *bracket = host[0] == '[' ? strchr(host, ']') : host;
    const char *colon = bracket ? strchr(bracket, ':') : NULL;
    if (!colon) return false;
    const size_t length = (size_t)(colon - host);
    char expected[16];
    (void)snprintf(expected, sizeof expected, "%u", port);
    if (strcmp(colon + 1, expected) != 0) return false;
    if (is_word(host, length, "localhost")) return true;
    if (loopback)
        return (is_ipv4(host, length) && strncmp(host, "127.", 4) == 0) || is_word(host, length, "[::1]");
    return is_ipv4(host, length) || is_ipv6(host, length);
}

bool hs_console_origin_is_ours(const char *origin, const char *host) {
    static const char scheme[] = "http://";
    return origin && host && strncmp(origin, scheme, sizeof scheme - 1) == 0 &&
           strcmp(origin + sizeof scheme - 1, host) == 0;
}
