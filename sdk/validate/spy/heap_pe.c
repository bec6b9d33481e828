/* SPDX-License-Identifier: MIT */
/* What library_pe.c puts in the place of the heap's functions. A library that brings an allocator of its own
 * is not seen. */
#include "validate/spy/heap_spy.h"
#include "validate/spy/library.h"

#include <malloc.h>
#include <stdlib.h>

/* Of the C library that the library under test uses: none knows the blocks of another. */
#define NEXT(name) (__extension__(__typeof__(&name)) library_next(#name))

void *instead_of_malloc(size_t bytes);
void *instead_of_calloc(size_t count, size_t bytes);
void *instead_of_realloc(void *block, size_t bytes);
void instead_of_free(void *block);

bool heap_spy_works(void) {
    return true;
}

size_t heap_spy_size(void *block) {
    return NEXT(_msize)(block);
}

void *instead_of_malloc(size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, NEXT(malloc)(bytes));
}

void *instead_of_calloc(size_t count, size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, NEXT(calloc)(count, bytes));
}

void *instead_of_realloc(void *block, size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    if (v == HEAP_SPY_FAILS) return NULL;
    heap_spy_lose(block);
    return heap_spy_keep(v, NEXT(realloc)(block, bytes));
}

void instead_of_free(void *block) {
    heap_spy_lose(block);
    NEXT(free)(block);
}
