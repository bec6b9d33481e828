/* SPDX-License-Identifier: MIT */
/* How a program knows that it is a child, and where its handles are. */
#include "core/system.h"
#include "guard/child_system.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MARK "child:"

static char **own_arguments;
static intptr_t handles[HS_CHILD_HANDLES];
static uint32_t handle_count;

void hs_child_mark(char *out, size_t bytes, const intptr_t *list, uint32_t count) {
    int used = snprintf(out, bytes, MARK);
    for (uint32_t i = 0; i < count; i++)
        used += snprintf(out + used, bytes - (size_t)used, "%s%" PRIdPTR, i ? "," : "", list[i]);
}

/* The handles of a mark. False: it is none, but an argument that begins as one. */
static bool read_mark(const char *at) {
    uint32_t count = 0;
    if (strncmp(at, MARK, strlen(MARK)) != 0) return false;
    at += strlen(MARK) - 1;
    do {
        char *end;
        if (count == HS_CHILD_HANDLES || at[1] < '0' || at[1] > '9') return false;
        handles[count++] = (intptr_t)strtoll(at + 1, &end, 10);
        at = end;
    } while (*at == ',');
    if (*at || count < 2 || !hs_child_is_channel(handles[0])) return false;
    handle_count = count;
    return true;
}

bool hs_child_take(int *argc, char **argv) {
    own_arguments = argv;
    if (*argc < 2 || !read_mark(argv[*argc - 1])) return false;
    argv[--*argc] = NULL;
    sys_end_at_fault();
    hs_child_settle(hs_child_handle(1));
    return true;
}

bool hs_child_is_one(void) {
    return handle_count > 0;
}

intptr_t hs_child_handle(uint32_t n) {
    return n < handle_count ? handles[n] : -1;
}

intptr_t hs_child_passed(uint32_t n) {
    return hs_child_handle(n ? n + 1 : 0);
}

char **hs_child_arguments(void) {
    return own_arguments;
}
