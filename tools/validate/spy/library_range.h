/* SPDX-License-Identifier: MIT */
/* The addresses at which a loaded library lies. */
#ifndef SV_LIBRARY_RANGE_H
#define SV_LIBRARY_RANGE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uintptr_t start, end; /* both 0: none */
} library_range;

/* Of the program or library that holds this address. */
library_range library_range_of(const void *address);

static inline bool library_range_holds(library_range range, const void *address) {
    return (uintptr_t)address >= range.start && (uintptr_t)address < range.end;
}

#endif
