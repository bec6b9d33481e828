/* SPDX-License-Identifier: MIT */
/* The heap's names, which come before those of the process's allocator. */
#include "validate/spy/heap_spy.h"

#include <dlfcn.h>
#include <stddef.h>
#include <string.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITHOUT_HEAP_SPY
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define WITHOUT_HEAP_SPY
#endif

extern size_t malloc_usable_size(void *block); /* of the process's allocator */
size_t heap_spy_size(void *block) {
    return malloc_usable_size(block);
}

#if defined(WITHOUT_HEAP_SPY)

bool heap_spy_works(void) {
    return false;
}

#else

bool heap_spy_works(void) {
    return true;
}

/* The allocator of the process, glibc's or one that was loaded first (jemalloc, AddressSanitizer): it has all
 * blocks, those of posix_memalign too, which are not counted, or frees what is not its own. */
static struct {
    void *(*malloc)(size_t bytes);
    void *(*calloc)(size_t count, size_t bytes);
    void *(*realloc)(void *block, size_t bytes);
    void (*free)(void *block);
} next;

/* What dlsym itself asks for, before there is an allocator: given out once. */
static _Alignas(16) unsigned char early[4096];
static size_t early_used;

static void *give_early(size_t bytes) {
    const size_t room = (bytes + 15) / 16 * 16, at = early_used;
    if (bytes > sizeof early || room > sizeof early - at) return NULL;
    early_used += room;
    return early + at;
}

static bool is_early(const void *block) {
    return (const unsigned char *)block >= early && (const unsigned char *)block < early + sizeof early;
}

/* False while dlsym is under way: the process has one thread then. */
static bool find_next(void) {
    static bool searching;
    if (next.free) return true;
    if (searching) return false;
    searching = true;
    *(void **)&next.malloc = dlsym(RTLD_NEXT, "malloc");
    *(void **)&next.calloc = dlsym(RTLD_NEXT, "calloc");
    *(void **)&next.realloc = dlsym(RTLD_NEXT, "realloc");
    *(void **)&next.free = dlsym(RTLD_NEXT, "free");
    searching = false;
    return true;
}

void *malloc(size_t bytes);
void *calloc(size_t count, size_t bytes);
void *realloc(void *block, size_t bytes);
void free(void *block);

void *malloc(size_t bytes) {
    if (!find_next()) return give_early(bytes);
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, next.malloc(bytes));
}

void *calloc(size_t count, size_t bytes) {
    if (!find_next()) return count && bytes > sizeof early / count ? NULL : give_early(count * bytes);
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    return v == HEAP_SPY_FAILS ? NULL : heap_spy_keep(v, next.calloc(count, bytes));
}

void *realloc(void *block, size_t bytes) {
    if (!find_next() || is_early(block)) { /* it never was freed, and what is behind it is 0 */
        void *moved = find_next() ? next.malloc(bytes) : give_early(bytes);
        const size_t there = block ? (size_t)(early + sizeof early - (unsigned char *)block) : 0;
        if (moved && block) memcpy(moved, block, bytes < there ? bytes : there);
        return moved;
    }
    const heap_spy_verdict v = heap_spy_judge(__builtin_return_address(0));
    if (v == HEAP_SPY_FAILS) return NULL;
    heap_spy_lose(block);
    return heap_spy_keep(v, next.realloc(block, bytes));
}

void free(void *block) {
    if (!block || is_early(block) || !find_next()) return;
    heap_spy_lose(block);
    next.free(block);
}

#endif
