/* SPDX-License-Identifier: MIT */
#include "validate/spy/heap_spy.h"

#include "validate/spy/library_range.h"

#include <assert.h>
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITHOUT_HEAP_SPY
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define WITHOUT_HEAP_SPY
#endif

enum { PLACES = 1 << 16, MAX_BLOCKS = PLACES / 2 };

static struct {
    library_range watched;
    uint32_t count, fail_in;
    uint32_t live;
    void *blocks[PLACES]; /* the live ones, by address: whoever frees one, for a tail call hides its caller */
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
extern size_t malloc_usable_size(void *block); /* of glibc */
uint64_t heap_spy_bytes(void) {
    uint64_t bytes = 0;
    for (size_t i = 0; i < PLACES; i++)
        if (spy.blocks[i]) bytes += malloc_usable_size(spy.blocks[i]);
    return bytes;
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
typedef enum { FOREIGN, OURS, FAILS } spy_heap_verdict;

static spy_heap_verdict judge(const void *caller) {
    if (!library_range_holds(spy.watched, caller)) return FOREIGN;
    spy.count++;
    if (spy.fail_in == 0 || --spy.fail_in > 0) return OURS;
    spy.failed = true;
    errno = ENOMEM;
    return FAILS;
}

/* Other threads free blocks, too. */
static atomic_flag busy = ATOMIC_FLAG_INIT;
static void lock(void) {
    while (atomic_flag_test_and_set_explicit(&busy, memory_order_acquire)) {
    }
}
static void unlock(void) {
    atomic_flag_clear_explicit(&busy, memory_order_release);
}

/* Where a block's search begins; it goes on to the next empty place. */
static size_t home_of(const void *block) {
    return ((uintptr_t)block >> 4) * 0x9e3779b97f4a7c15u >> 48;
}

static void *keep(spy_heap_verdict v, void *block) {
    if (v != OURS || !block) return block;
    lock();
    assert(spy.live < MAX_BLOCKS);
    size_t i = home_of(block);
    while (spy.blocks[i]) i = (i + 1) % PLACES;
    spy.blocks[i] = block;
    spy.live++;
    unlock();
    return block;
}

/* Empties place i, and moves back whatever was found through it. */
static void empty(size_t i) {
    for (size_t k = (i + 1) % PLACES; spy.blocks[k]; k = (k + 1) % PLACES) {
        const size_t home = home_of(spy.blocks[k]);
        if ((k + PLACES - home) % PLACES < (k + PLACES - i) % PLACES) continue;
        spy.blocks[i] = spy.blocks[k];
        i = k;
    }
    spy.blocks[i] = NULL;
    spy.live--;
}

static void lose(const void *block) {
    if (!block || spy.live == 0) return;
    lock();
    size_t i = home_of(block);
    while (spy.blocks[i] && spy.blocks[i] != block) i = (i + 1) % PLACES;
    if (spy.blocks[i]) empty(i);
    unlock();
}

void *malloc(size_t bytes) {
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, __libc_malloc(bytes));
}

void *calloc(size_t count, size_t bytes) {
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, __libc_calloc(count, bytes));
}

void *realloc(void *block, size_t bytes) {
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    if (v == FAILS) return NULL;
    lose(block);
    return keep(v, __libc_realloc(block, bytes));
}

void free(void *block) {
    lose(block);
    __libc_free(block);
}

#endif
