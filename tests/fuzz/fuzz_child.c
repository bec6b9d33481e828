/* SPDX-License-Identifier: MIT */
/* The argument that tells a program it is a child: any bytes, with child_self.c alone. It is read as the
 * grammar says, "child:" and 2 to HS_CHILD_HANDLES whole numbers with commas between them, and whatever is
 * not that is left to the program. What hs_child_mark writes is read as it was. */
#include "fuzz/fuzz_target.h"
#include "guard/child_system.h"

#include <stdlib.h>
#include <string.h>

static intptr_t asked; /* the handle that was asked for; -1: none */

/* None is a channel: so the argument is never taken, and this process stays what it is. */
bool hs_child_is_channel(intptr_t handle) {
    asked = handle;
    return false;
}

void hs_child_settle(intptr_t handle) {
    FUZZ_HOLDS(handle < 0);
}

/* Whole numbers with commas between; 0: there is something else. */
static uint32_t count_numbers(const char *at) {
    uint32_t count = 0;
    for (;; at++) {
        const size_t digits = strspn(at, "0123456789");
        if (digits == 0) return 0;
        count++;
        at += digits;
        if (*at != ',') return *at ? 0 : count;
    }
}

static void take(char *text) {
    char name[] = "fuzz";
    char *argv[] = {name, text, NULL};
    int argc = 2;
    asked = -1;
    FUZZ_HOLDS(!hs_child_take(&argc, argv) && argc == 2 && argv[1] == text && !hs_child_is_one());
}

static void check_any(char *text) {
    static const char mark[] = "child:";
    const bool begins = strncmp(text, mark, strlen(mark)) == 0;
    const uint32_t count = begins ? count_numbers(text + strlen(mark)) : 0;
    take(text);
    FUZZ_HOLDS((asked >= 0) == (count >= 2 && count <= HS_CHILD_HANDLES));
    if (asked >= 0) FUZZ_HOLDS(asked == (intptr_t)strtoll(text + strlen(mark), NULL, 10));
}

static void check_ours(const uint8_t *data, size_t size) {
    intptr_t list[HS_CHILD_HANDLES];
    char text[64 + HS_CHILD_HANDLES * 24];
    const uint32_t count = 2 + (size ? data[0] % (HS_CHILD_HANDLES - 1) : 0);
    for (uint32_t i = 0; i < count; i++) list[i] = size > i + 1 ? data[i + 1] : (intptr_t)i;
    hs_child_mark(text, sizeof text, list, count);
    take(text);
    FUZZ_HOLDS(asked == list[0]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *text = malloc(size + 1);
    if (!text) abort();
    memcpy(text, data, size);
    text[size] = '\0';
    check_any(text);
    free(text);
    check_ours(data, size);
    return 0;
}
