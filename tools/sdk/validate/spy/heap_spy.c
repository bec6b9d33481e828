/* SPDX-License-Identifier: MIT */
#include "validate/spy/heap_spy.h"

#include "validate/spy/library_range.h"

#include <assert.h>
#include <dlfcn.h>
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
extern size_t malloc_usable_size(void *block); /* of the process's allocator */
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
    if (!find_next()) return give_early(bytes);
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, next.malloc(bytes));
}

void *calloc(size_t count, size_t bytes) {
    if (!find_next()) return count && bytes > sizeof early / count ? NULL : give_early(count * bytes);
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    return v == FAILS ? NULL : keep(v, next.calloc(count, bytes));
}

void *realloc(void *block, size_t bytes) {
    if (!find_next() || is_early(block)) { /* it never was freed, and what is behind it is 0 */
        void *moved = find_next() ? next.malloc(bytes) : give_early(bytes);
        const size_t there = block ? (size_t)(early + sizeof early - (unsigned char *)block) : 0;
        if (moved && block) memcpy(moved, block, bytes < there ? bytes : there);
        return moved;
    }
    const spy_heap_verdict v = judge(__builtin_return_address(0));
    if (v == FAILS) return NULL;
    lose(block);
    return keep(v, next.realloc(block, bytes));
}

void free(void *block) {
    if (!block || is_early(block) || !find_next()) return;
    lose(block);
    next.free(block);
}

#endif
