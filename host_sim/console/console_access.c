/* SPDX-License-Identifier: MIT */
#include "console/console.h"

#include <arpa/inet.h>
#include <stdio.h>
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

/* "1.2.3.4" or "[::1]". */
static bool is_address(const char *text, size_t length, int family) {
    char word[INET6_ADDRSTRLEN];
    uint8_t bytes[16];
    if (family == AF_INET6) {
        if (length < 4 || text[0] != '[' || text[length - 1] != ']') return false;
        text++;
        length -= 2;
    }
    return snprintf(word, sizeof word, "%.*s", (int)length, text) < (int)sizeof word &&
           inet_pton(family, word, bytes) == 1;
}

static bool is_word(const char *text, size_t length, const char *word) {
    return strlen(word) == length && strncmp(text, word, length) == 0;
}

bool hs_console_host_is_ours(const char *host, bool loopback) {
    if (!host) return false;
    const char *bracket = host[0] == '[' ? strchr(host, ']') : host;
    const char *colon = bracket ? strchr(bracket, ':') : NULL;
    if (!colon) return false;
    const size_t length = (size_t)(colon - host), digits = strlen(colon + 1);
    if (digits < 1 || digits > 5 || strspn(colon + 1, "0123456789") != digits) return false;
    if (is_word(host, length, "localhost")) return true;
    if (loopback)
        return (is_address(host, length, AF_INET) && strncmp(host, "127.", 4) == 0) ||
               is_word(host, length, "[::1]");
    return is_address(host, length, AF_INET) || is_address(host, length, AF_INET6);
}

bool hs_console_behind(const char *address, char *origin, size_t bytes) {
    const char *const slashes = strstr(address, "://");
    if (strncmp(address, "http://", 7) != 0 && strncmp(address, "https://", 8) != 0) return false;
    const size_t host =
        strspn(slashes + 3, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-:[]");
    const char *const path = slashes + 3 + host;
    const size_t length = (size_t)(path - address);
    if (host == 0 || path[0] != '/' || path[strlen(path) - 1] != '/' || length >= bytes) return false;
    if (strcspn(path, "?#\"<> ") != strlen(path)) return false;
    memcpy(origin, address, length);
    origin[length] = '\0';
    return true;
}

bool hs_console_origin_is_ours(const char *origin, const char *host) {
    static const char scheme[] = "http://";
    return origin && host && strncmp(origin, scheme, sizeof scheme - 1) == 0 &&
           strcmp(origin + sizeof scheme - 1, host) == 0;
}
