/* SPDX-License-Identifier: MIT */
#include "core/threads.h"

#include "core/system.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct {
    atomic_uint next;
    uint32_t blocks;
    hs_block_fn fn;
    void *context;
} job;

static void *work(void *argument) {
    job *j = argument;
    for (;;) {
        uint32_t block = atomic_fetch_add(&j->next, 1u);
        if (block >= j->blocks) return NULL;
        j->fn(j->context, block);
    }
}

void hs_parallel(uint32_t threads, uint32_t blocks, hs_block_fn fn, void *context) {
    job j = {.blocks = blocks, .fn = fn, .context = context};
    atomic_init(&j.next, 0u);
    if (threads > blocks) threads = blocks;
    pthread_t helpers[HS_MAX_THREADS];
    uint32_t started = 0;
    while (started + 1 < threads && pthread_create(&helpers[started], NULL, work, &j) == 0) started++;
    work(&j);
    for (uint32_t i = 0; i < started; i++) pthread_join(helpers[i], NULL);
}

typedef struct {
    hs_block_try_fn fn;
    void *context;
    atomic_uint failed; /* the first block that failed so far, or the number of blocks */
    pthread_mutex_t lock;
    hs_error error; /* of that block; with the lock held */
} trial;

static void try_block(void *context, uint32_t block) {
    trial *t = context;
    hs_error error = {0};
    if (block > atomic_load(&t->failed) || t->fn(t->context, block, &error)) return;
    pthread_mutex_lock(&t->lock);
    if (block < atomic_load(&t->failed)) {
        atomic_store(&t->failed, block);
        t->error = error;
    }
    pthread_mutex_unlock(&t->lock);
}

bool hs_parallel_try(uint32_t threads, uint32_t blocks, hs_block_try_fn fn, void *context, hs_error *err) {
    trial t = {.fn = fn, .context = context, .lock = PTHREAD_MUTEX_INITIALIZER};
    atomic_init(&t.failed, blocks);
    hs_parallel(threads, blocks, try_block, &t);
    (void)pthread_mutex_destroy(&t.lock);
    return atomic_load(&t.failed) == blocks || hs_fail(err, t.error.code, "%s", t.error.text);
}

uint32_t hs_thread_count(uint32_t wanted) {
    const uint32_t count = wanted ? wanted : sys_processors();
    return count < HS_MAX_THREADS ? count : HS_MAX_THREADS;
}
