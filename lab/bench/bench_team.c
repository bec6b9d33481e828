/* SPDX-License-Identifier: MIT */
/* Two persistent threads, the caller and one more, for the C side of the benchmark. */
#include "bench/bench.h"

#include <linux/futex.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Looks before a waiting thread goes to sleep: some 50 us, longer than the halves of a job differ. Sleeping,
 * and not yielding: on a busy machine a thread that yields waits for everybody else's time slice. */
enum { SPINS = 4096 };

struct bench_team {
    pthread_t thread;
    bool two_processors;                      /* there are two processors for two threads: */
    cpu_set_t processors, own[BENCH_THREADS]; /* all, and one for each to start on */
    atomic_uint started, finished;            /* jobs given out; jobs the second thread is through with */
    atomic_uint arrived, phase;               /* of the barrier */
    atomic_uint sleepers;
    /* Written before `started` moves on. */
    void (*job)(void *context, unsigned thread);
    void *context;
    bool nap, quit; /* after this job: sleep at once, end */
};

/* Returns once *word is no longer `old`. */
static void wait_change(bench_team *team, atomic_uint *word, unsigned old, unsigned spins) {
    for (unsigned i = 0; i < spins; i++) {
        if (atomic_load_explicit(word, memory_order_acquire) != old) return;
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#endif
    }
    while (atomic_load(word) == old) {
        atomic_fetch_add(&team->sleepers, 1);
        (void)syscall(SYS_futex, word, FUTEX_WAIT_PRIVATE, old, NULL, NULL, 0);
        atomic_fetch_sub(&team->sleepers, 1);
    }
}

/* Moves *word on and wakes whoever sleeps on it. A thread that is about to sleep has counted itself first,
 * and the kernel lets it sleep only if the word has not moved: so it is either woken or never asleep. */
static void move_on(bench_team *team, atomic_uint *word) {
    atomic_fetch_add(word, 1);
    if (atomic_load(&team->sleepers) > 0)
        (void)syscall(SYS_futex, word, FUTEX_WAKE_PRIVATE, BENCH_THREADS, NULL, NULL, 0);
}

static void *second_thread(void *argument) {
    bench_team *team = argument;
    unsigned done = 0;
    bool nap = true;
    for (;;) {
        wait_change(team, &team->started, done++, nap ? 0 : SPINS);
        const bool quit = team->quit;
        nap = team->nap;
        if (team->job) team->job(team->context, 1);
        move_on(team, &team->finished);
        if (quit) return NULL;
    }
}

/* Gives the second thread a job, or none: then it only does what nap and quit say. */
static unsigned start_job(bench_team *team, void (*job)(void *context, unsigned thread), void *context,
                          bool nap) {
    const unsigned before = atomic_load(&team->finished);
    team->job = job;
    team->context = context;
    team->nap = nap;
    move_on(team, &team->started);
    return before;
}

/* Finds a processor for each thread. */
static void find_processors(bench_team *team) {
    unsigned found = 0;
    if (sched_getaffinity(0, sizeof team->processors, &team->processors) != 0) return;
    for (size_t p = 0; p < CPU_SETSIZE && found < BENCH_THREADS; p++) {
        if (!CPU_ISSET(p, &team->processors)) continue;
        CPU_ZERO(&team->own[found]);
        CPU_SET(p, &team->own[found++]);
    }
    team->two_processors = found == BENCH_THREADS;
}

/* The system likes to wake a thread where the waking one runs, and is slow to part them: so each is sent to
 * its own processor, and then left free to go where there is room. What fails here costs time, no more. */
static void part_threads(const bench_team *team) {
    if (!team->two_processors) return;
    (void)pthread_setaffinity_np(team->thread, sizeof team->own[1], &team->own[1]);
    (void)pthread_setaffinity_np(pthread_self(), sizeof team->own[0], &team->own[0]);
    (void)pthread_setaffinity_np(team->thread, sizeof team->processors, &team->processors);
    (void)pthread_setaffinity_np(pthread_self(), sizeof team->processors, &team->processors);
}

bench_team *bench_team_create(hs_error *err) {
    bench_team *team = calloc(1, sizeof *team);
    if (!team) {
        (void)hs_fail(err, HS_ERR_MEMORY, "benchmark threads: no memory");
        return NULL;
    }
    const int code = pthread_create(&team->thread, NULL, second_thread, team);
    if (code == 0) {
        find_processors(team);
        return team;
    }
    (void)hs_fail(err, HS_ERR_MEMORY, "benchmark threads: pthread_create gives %d", code);
    free(team);
    return NULL;
}

void bench_team_destroy(bench_team *team) {
    if (!team) return;
    team->quit = true;
    (void)start_job(team, NULL, NULL, true);
    (void)pthread_join(team->thread, NULL);
    free(team);
}

void bench_team_ready(bench_team *team) {
    wait_change(team, &team->finished, start_job(team, NULL, NULL, false), SPINS);
    part_threads(team);
    /* Once more: moving may have taken longer than it spins. */
    wait_change(team, &team->finished, start_job(team, NULL, NULL, false), SPINS);
}

void bench_team_rest(bench_team *team) {
    wait_change(team, &team->finished, start_job(team, NULL, NULL, true), SPINS);
}

void bench_team_run(bench_team *team, void (*job)(void *context, unsigned thread), void *context) {
    const unsigned before = start_job(team, job, context, false);
    job(context, 0);
    wait_change(team, &team->finished, before, SPINS);
}

void bench_team_barrier(bench_team *team) {
    const unsigned phase = atomic_load(&team->phase);
    if (atomic_fetch_add(&team->arrived, 1) == BENCH_THREADS - 1) {
        atomic_store(&team->arrived, 0);
        move_on(team, &team->phase);
        return;
    }
    wait_change(team, &team->phase, phase, SPINS);
}
