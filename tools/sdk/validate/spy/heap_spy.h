/* SPDX-License-Identifier: MIT */
/*
 * Between a library under test and the heap: counts its allocations, and makes one of them fail. Works as
 * cl_spy does, by defining malloc, calloc, realloc and free in the program; what returns into the watched
 * library counts. Not with AddressSanitizer, which needs these names itself: heap_spy_works() is false then.
 */
#ifndef SV_HEAP_SPY_H
#define SV_HEAP_SPY_H

#include <stdbool.h>
#include <stdint.h>

bool heap_spy_works(void);
void heap_spy_watch(const void *address);
void heap_spy_reset(void);      /* counts start again at 0, nothing fails; live blocks are kept */
uint32_t heap_spy_count(void);  /* allocations of the library since the reset */
uint32_t heap_spy_live(void);   /* its allocations that nobody has freed */
uint64_t heap_spy_bytes(void);  /* of these, as far as they may be used: malloc rounds up */
void heap_spy_fail(uint32_t n); /* its nth allocation from now on (1, 2, ...) returns NULL; 0: none */
bool heap_spy_failed(void);     /* that has happened */

#endif
