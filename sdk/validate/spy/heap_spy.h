/* SPDX-License-Identifier: MIT */
/*
 * Between a library under test and the heap: counts its allocations, and makes one of them fail. Works as
 * cl_spy does, by malloc, calloc, realloc and free of heap_elf.c or heap_pe.c; what returns into the watched
 * library counts. Not with AddressSanitizer, which needs these names itself: heap_spy_works() is false then.
 */
#ifndef SV_HEAP_SPY_H
#define SV_HEAP_SPY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

bool heap_spy_works(void);
void heap_spy_watch(const void *address);
void heap_spy_reset(void);      /* counts start again at 0, nothing fails; live blocks are kept */
uint32_t heap_spy_count(void);  /* allocations of the library since the reset */
uint32_t heap_spy_live(void);   /* its allocations that nobody has freed */
uint64_t heap_spy_bytes(void);  /* of these, as far as they may be used: malloc rounds up */
void heap_spy_fail(uint32_t n); /* its nth allocation from now on (1, 2, ...) returns NULL; 0: none */
bool heap_spy_failed(void);     /* that has happened */

/* ---- for heap_elf.c and heap_pe.c, which stand in for the heap's functions */

/* What becomes of an allocation. */
typedef enum { HEAP_SPY_FOREIGN, HEAP_SPY_OURS, HEAP_SPY_FAILS } heap_spy_verdict;

/* Counts an allocation; `caller` is where it returns to. */
heap_spy_verdict heap_spy_judge(const void *caller);

/* Notes its block, and that a block is freed. */
void *heap_spy_keep(heap_spy_verdict v, void *block);
void heap_spy_lose(const void *block);

/* Theirs: the bytes of a block as far as they may be used. */
size_t heap_spy_size(void *block);

#endif
