/* SPDX-License-Identifier: MIT */
/* What libFuzzer calls, and replay.c where there is no libFuzzer. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* One input; what is wrong with the code under test ends the process. Always 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A condition that must hold, whatever the input was. */
#define FUZZ_HOLDS(condition)                                                                                \
    do {                                                                                                     \
        if (!(condition)) fuzz_broken(__FILE__, __LINE__, #condition);                                       \
    } while (0)
void fuzz_broken(const char *file, int line, const char *condition);
