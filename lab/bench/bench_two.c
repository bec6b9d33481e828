/* SPDX-License-Identifier: MIT */
/* Two threads, the caller and one more, for the C side of the benchmark. */
#include "bench/bench.h"

#include "core/progress.h"

#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Looks before a waiting thread goes to sleep: some 50 us, longer than the halves of a job differ. Sleeping,
 * and not yielding: on a busy machine a thread that yields waits for everybody else's time slice. */
enum { SPINS = 4096 };

static void wait_change(bench_barrier *b, unsigned old) {
    for (unsigned i = 0; i < SPINS; i++) {
        if (atomic_load_explicit(&b->phase, memory_order_acquire) != old) return;
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#endif
    }
    while (atomic_load(&b->phase) == old) {
        atomic_fetch_add(&b->sleepers, 1);
        (void)syscall(SYS_futex, &b->phase, FUTEX_WAIT_PRIVATE, old, NULL, NULL, 0);
        atomic_fetch_sub(&b->sleepers, 1);
    }
}

/* A thread that is about to sleep has counted itself first, and the kernel lets it sleep only if the word has
 * not moved: so it is either woken or never asleep. */
void bench_barrier_wait(bench_barrier *b) {
    const unsigned phase = atomic_load(&b->phase);
    if (atomic_fetch_add(&b->arrived, 1) < BENCH_THREADS - 1) {
        wait_change(b, phase);
        return;
    }
    atomic_store(&b->arrived, 0);
    atomic_fetch_add(&b->phase, 1);
    if (atomic_load(&b->sleepers) > 0)
        (void)syscall(SYS_futex, &b->phase, FUTEX_WAKE_PRIVATE, BENCH_THREADS, NULL, NULL, 0);
}

typedef struct {
    void (*job)(void *context, unsigned thread);
    void *context;
    bench_barrier meeting;
    cpu_set_t processors;
} two;

/* The system likes to wake a thread where the waking one runs, and is slow to part them: so each goes to a
 * processor of its own, and is then left free to go where there is room. What fails here costs time, no
 * more. */
static void go_apart(const two *t, unsigned thread) {
    unsigned found = 0;
    for (size_t p = 0; p < CPU_SETSIZE; p++) {
        if (!CPU_ISSET(p, &t->processors) || found++ != thread) continue;
        cpu_set_t own;
        CPU_ZERO(&own);
        CPU_SET(p, &own);
        (void)pthread_setaffinity_np(pthread_self(), sizeof own, &own);
        (void)pthread_setaffinity_np(pthread_self(), sizeof t->processors, &t->processors);
        return;
    }
}

static void *second_thread(void *argument) {
    two *t = argument;
    go_apart(t, 1);
    bench_barrier_wait(&t->meeting);
    t->job(t->context, 1);
    bench_barrier_wait(&t->meeting);
    return NULL;
}

bool bench_two_run(void (*job)(void *context, unsigned thread), void *context, double *ms, hs_error *err) {
    pthread_t thread;
    two t = {.job = job, .context = context};
    if (sched_getaffinity(0, sizeof t.processors, &t.processors) != 0) CPU_ZERO(&t.processors);
    const int code = pthread_create(&thread, NULL, second_thread, &t);
    if (code != 0) return hs_fail(err, HS_ERR_MEMORY, "benchmark threads: pthread_create gives %d", code);
    go_apart(&t, 0);
    bench_barrier_wait(&t.meeting);
    const double start = hs_now();
    job(context, 0);
    bench_barrier_wait(&t.meeting);
    *ms = (hs_now() - start) * 1e3;
    (void)pthread_join(thread, NULL);
    return true;
}
