/* SPDX-License-Identifier: MIT */
/* What library_pe.c puts in the place of the heap's functions. A library that brings an allocator of its own
 * is not seen. */
#include "validate/spy/heap_spy.h"

#include <malloc.h>
#include <stdlib.h>

void *spy_malloc(size_t bytes);
void *spy_calloc(size_t count, size_t bytes);
void *spy_realloc(void *block, size_t bytes);
void spy_free(void *block);

bool heap_spy_works(void) {
    return true;
}

size_t heap_spy_size(void *block) {
    return _msize(block);
}

void *spy_malloc(size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, malloc(bytes));
}

void *spy_calloc(size_t count, size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, calloc(count, bytes));
}

void *spy_realloc(void *block, size_t bytes) {
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    if (v == HEAP_SPY_FAILS) return NULL;
    heap_spy_lose(block);
    return heap_spy_keep(v, realloc(block, bytes));
}

void spy_free(void *block) {
    heap_spy_lose(block);
    free(block);
}
