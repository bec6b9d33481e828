#include "bench_team.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Looks before a waiting thread yields its core: some 10 us, longer than the threads of a balanced job
 * differ. */
enum { SPINS = 4096 };

struct bench_team {
    pthread_t thread;
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    bool wanted, quit;                        /* guarded by mutex: the second thread shall run; shall end */
    bool parted;                              /* there are two processors for two threads: */
    cpu_set_t processors, own[BENCH_THREADS]; /* all, and one for each to start on */
    atomic_bool awake;                        /* the second thread is out of its sleep */
    atomic_bool resting;
    atomic_uint started, finished; /* jobs given out; jobs the second thread is through with */
    atomic_uint arrived, phase;    /* of the barrier */
    void (*job)(void *context, unsigned thread);
    void *context;
};

static void pause_or_yield(unsigned *spins) {
    if (++*spins < SPINS) {
#if defined(__x86_64__) || defined(__i386__)
        __builtin_ia32_pause();
#endif
        return;
    }
    *spins = 0;
    (void)sched_yield();
}

/* Takes jobs until the team rests. */
static void serve(bench_team *team) {
    unsigned spins = 0;
    unsigned done = atomic_load(&team->finished);
    atomic_store(&team->awake, true);
    while (!atomic_load_explicit(&team->resting, memory_order_acquire)) {
        if (atomic_load_explicit(&team->started, memory_order_acquire) == done) {
            pause_or_yield(&spins);
            continue;
        }
        team->job(team->context, 1);
        atomic_store_explicit(&team->finished, ++done, memory_order_release);
    }
    atomic_store(&team->awake, false);
}

static void *second_thread(void *argument) {
    bench_team *team = argument;
    for (;;) {
        pthread_mutex_lock(&team->mutex);
        while (!team->wanted && !team->quit) pthread_cond_wait(&team->wake, &team->mutex);
        const bool quit = team->quit;
        team->wanted = false;
        pthread_mutex_unlock(&team->mutex);
        if (quit) return NULL;
        serve(team);
    }
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
    team->parted = found == BENCH_THREADS;
}

/* The system likes to wake a thread where the waking one runs, and is slow to part them: so each is sent to
 * its own processor, and then left free to go where there is room. What fails here costs time, no more. */
static void part_threads(const bench_team *team) {
    if (!team->parted) return;
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
    (void)pthread_mutex_init(&team->mutex, NULL);
    (void)pthread_cond_init(&team->wake, NULL);
    atomic_store(&team->resting, true);
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
    bench_team_rest(team);
    pthread_mutex_lock(&team->mutex);
    team->quit = true;
    pthread_cond_signal(&team->wake);
    pthread_mutex_unlock(&team->mutex);
    (void)pthread_join(team->thread, NULL);
    (void)pthread_cond_destroy(&team->wake);
    (void)pthread_mutex_destroy(&team->mutex);
    free(team);
}

void bench_team_ready(bench_team *team) {
    unsigned spins = 0;
    if (!atomic_load(&team->resting)) return;
    atomic_store(&team->resting, false);
    pthread_mutex_lock(&team->mutex);
    team->wanted = true;
    pthread_cond_signal(&team->wake);
    pthread_mutex_unlock(&team->mutex);
    while (!atomic_load(&team->awake)) pause_or_yield(&spins);
    part_threads(team);
}

void bench_team_rest(bench_team *team) {
    unsigned spins = 0;
    atomic_store(&team->resting, true);
    while (atomic_load(&team->awake)) pause_or_yield(&spins);
}

void bench_team_run(bench_team *team, void (*job)(void *context, unsigned thread), void *context) {
    unsigned spins = 0;
    team->job = job;
    team->context = context;
    const unsigned number = atomic_load(&team->started) + 1;
    atomic_store_explicit(&team->started, number, memory_order_release);
    job(context, 0);
    while (atomic_load_explicit(&team->finished, memory_order_acquire) != number) pause_or_yield(&spins);
}

void bench_team_barrier(bench_team *team) {
    unsigned spins = 0;
    const unsigned phase = atomic_load(&team->phase);
    if (atomic_fetch_add(&team->arrived, 1) == BENCH_THREADS - 1) {
        atomic_store(&team->arrived, 0);
        atomic_fetch_add(&team->phase, 1);
        return;
    }
    while (atomic_load_explicit(&team->phase, memory_order_acquire) == phase) pause_or_yield(&spins);
}
