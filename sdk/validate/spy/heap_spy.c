/* SPDX-License-Identifier: MIT */
#include "validate/spy/heap_spy.h"

#include "validate/spy/library.h"

#include <assert.h>
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

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
    library_redirect(address);
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
uint64_t heap_spy_bytes(void) {
    uint64_t bytes = 0;
    for (size_t i = 0; i < PLACES; i++)
        if (spy.blocks[i]) bytes += heap_spy_size(spy.blocks[i]);
    return bytes;
}
bool heap_spy_failed(void) {
    return spy.failed;
}

void heap_spy_fail(uint32_t n) {
    spy.fail_in = n;
    spy.failed = false;
}

/* Other threads (the driver's) never return into the library. */
heap_spy_verdict heap_spy_judge(const void *caller) {
    if (!library_range_holds(spy.watched, caller)) return HEAP_SPY_FOREIGN;
    spy.count++;
    if (spy.fail_in == 0 || --spy.fail_in > 0) return HEAP_SPY_OURS;
    spy.failed = true;
    errno = ENOMEM;
    return HEAP_SPY_FAILS;
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

void *heap_spy_keep(heap_spy_verdict v, void *block) {
    if (v != HEAP_SPY_OURS || !block) return block;
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

void heap_spy_lose(const void *block) {
    if (!block || spy.live == 0) return;
    lock();
    size_t i = home_of(block);
    while (spy.blocks[i] && spy.blocks[i] != block) i = (i + 1) % PLACES;
    if (spy.blocks[i]) empty(i);
    unlock();
}
