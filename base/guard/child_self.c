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

bool hs_child_take(int *argc, char **argv) {
    const char *last = *argc > 1 ? argv[*argc - 1] : "";
    own_arguments = argv;
    if (strncmp(last, MARK, strlen(MARK)) != 0) return false;
    last += strlen(MARK) - 1;
    while (*last && handle_count < HS_CHILD_HANDLES) {
        char *end;
        handles[handle_count++] = (intptr_t)strtoll(last + 1, &end, 10);
        last = end;
    }
    argv[--*argc] = NULL;
    sys_end_at_fault();
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
