/* SPDX-License-Identifier: MIT */
#include "scene/scene_locate.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

/* The text is well-formed: it has been parsed before. */
static const char *skip_space(const char *p) {
    while (*p && isspace((unsigned char)*p)) p++;
    return p;
}

static const char *skip_string(const char *p) {
    for (p++; *p && *p != '"'; p++)
        if (*p == '\\' && p[1]) p++;
    return *p ? p + 1 : p;
}

static const char *skip_value(const char *p) {
    int depth = 0;
    p = skip_space(p);
    do {
        if (*p == '"') {
            p = skip_string(p);
        } else {
            if (*p == '{' || *p == '[') depth++;
            if (*p == '}' || *p == ']') depth--;
            if (depth == 0 && *p != '}' && *p != ']') /* number, true, false, null */
                while (*p && !strchr(",]} \t\r\n", *p)) p++;
            else if (*p)
                p++;
        }
        if (depth > 0)
            while (*p && strchr(", :\t\r\n", *p)) p++;
    } while (*p && depth > 0);
    return p;
}

/* The value of `key` in the object at p, or NULL. */
static const char *member(const char *p, const char *key, size_t length) {
    if (*p != '{') return NULL;
    for (p = skip_space(p + 1); *p == '"'; p = skip_space(p)) {
        const char *name = p + 1;
        const char *end = skip_string(p);
        bool found = (size_t)(end - name) == length + 1 && strncmp(name, key, length) == 0;
        p = skip_space(end);
        p = skip_space(*p == ':' ? p + 1 : p);
        if (found) return p;
        p = skip_space(skip_value(p));
        if (*p == ',') p++;
    }
    return NULL;
}

static const char *element(const char *p, size_t index) {
    if (*p != '[') return NULL;
    p = skip_space(p + 1);
    for (; *p && *p != ']'; index--) {
        if (index == 0) return p;
        p = skip_space(skip_value(p));
        if (*p == ',') p = skip_space(p + 1);
    }
    return NULL;
}

unsigned hs_json_line(const char *text, const char *where) {
    const char *p = skip_space(text);
    while (*where) {
        const char *next;
        if (*where == '[') {
            size_t index = 0;
            for (where++; isdigit((unsigned char)*where); where++)
                index = 10 * index + (size_t)(*where - '0');
            if (*where == ']') where++;
            next = element(p, index);
        } else {
            size_t length = strcspn(where, ".[");
            next = member(p, where, length);
            where += length;
        }
        if (!next) break;
        p = next;
        if (*where == '.') where++;
    }
    unsigned line = 1;
    for (const char *c = text; c < p; c++) line += *c == '\n';
    return line;
}
