/* SPDX-License-Identifier: MIT */
#include "spy/heap_spy.h"

#include "spy/library_range.h"

#include <assert.h>
#include <errno.h>
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

enum { MOST_BLOCKS = 256 };

static struct {
    library_range watched;
    uint32_t count, fail_in;
    uint32_t live;
    void *blocks[MOST_BLOCKS]; /* the live ones: whoever frees one, for a tail call hides its caller */
    bool failed;
} spy;

void heap_spy_watch(const void *address) {
    memset(&spy, 0, sizeof spy);
    spy.watched = library_range_of(address);
}

void heap_spy_reset(void) {
    spy.count = spy.fail_in = 0;
    spy.failed = false;
}

uint32_t heap_spy_count(void) {
    return spy.count;
}
uint32_t heap_spy_live(void) {
    return spy.live;
}
bool heap_spy_failed(void) {
    return spy.failed;
}

void heap_spy_fail(uint32_t n) {
    spy.fail_in = n;
    spy.failed = false;
}

#if defined(WITHOUT_HEAP_SPY)

bool heap_spy_works(void) {
    return false;
}

#else

bool heap_spy_works(void) {
    return true;
}

/* glibc's own, under names that nobody replaces. */
extern void *__libc_malloc(size_t bytes);
extern void *__libc_calloc(size_t count, size_t bytes);
extern void *__libc_realloc(void *block, size_t bytes);
extern void __libc_free(void *block);

void *malloc(size_t bytes);
void *calloc(size_t count, size_t bytes);
void *realloc(void *block, size_t bytes);
void free(void *block);

/* What becomes of an allocation. Other threads (the driver's) never return into the library. */
typedef enum { FOREIGN, OURS, FAILS } verdict;

static verdict judge(const void *caller) {
    if (!library_range_holds(spy.watched, caller)) return FOREIGN;
    spy.count++;
    if (spy.fail_in == 0 || --spy.fail_in > 0) return OURS;
    spy.failed = true;
    errno = ENOMEM;
    return FAILS;
}

static void *keep(verdict v, void *block) {
    if (v != OURS || !block) return block;
    assert(spy.live < MOST_BLOCKS);
    spy.blocks[spy.live++] = block;
    return block;
}

static void lose(const void *block) {
    for (uint32_t i = 0; block && i < spy.live; i++)
        if (spy.blocks[i] == block) {
            spy.blocks[i] = spy.blocks[--spy.live];
            return;
        }
}

void *malloc(size_t bytes) {
    const verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, __libc_malloc(bytes));
}

void *calloc(size_t count, size_t bytes) {
    const verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, __libc_calloc(count, bytes));
}

void *realloc(void *block, size_t bytes) {
    const verdict v = judge(__builtin_return_address(0));
    if (v == FAILS) return NULL;
    lose(block);
    return keep(v, __libc_realloc(block, bytes));
}

void free(void *block) {
    lose(block);
    __libc_free(block);
}

#endif
