#include "heap_spy.h"

#include "library_range.h"

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

static struct {
    library_range watched;
    uint32_t count, fail_in;
    int32_t live;
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
int32_t heap_spy_live(void) {
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

/* False if this allocation is to fail. Other threads (the driver's) never return into the library. */
static bool allowed(const void *caller) {
    if (!library_range_holds(spy.watched, caller)) return true;
    spy.count++;
    if (spy.fail_in == 0 || --spy.fail_in > 0) {
        spy.live++;
        return true;
    }
    spy.failed = true;
    errno = ENOMEM;
    return false;
}

void *malloc(size_t bytes) {
    return allowed(__builtin_return_address(0)) ? __libc_malloc(bytes) : NULL;
}

void *calloc(size_t count, size_t bytes) {
    return allowed(__builtin_return_address(0)) ? __libc_calloc(count, bytes) : NULL;
}

void *realloc(void *block, size_t bytes) {
    if (!allowed(__builtin_return_address(0))) return NULL;
    if (block && library_range_holds(spy.watched, __builtin_return_address(0))) spy.live--;
    return __libc_realloc(block, bytes);
}

void free(void *block) {
    if (block && library_range_holds(spy.watched, __builtin_return_address(0))) spy.live--;
    __libc_free(block);
}

#endif
