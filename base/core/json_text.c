/* SPDX-License-Identifier: MIT */
#include "core/json_text.h"

#include <stdlib.h>
#include <string.h>

json_t *hs_json_text(const char *bytes) {
    if (!bytes) return json_string("");
    json_t *value = json_string(bytes);
    if (value) return value;
    char *copy = strdup(bytes);
    if (!copy) return NULL;
    for (char *c = copy; *c; c++)
        if ((unsigned char)*c >= 0x80) *c = '?';
    value = json_string(copy);
    free(copy);
    return value;
}
