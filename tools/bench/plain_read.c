/* SPDX-License-Identifier: MIT */
/* (a) of the benchmark: the volume's bytes, once through, by two threads. */
#include "bench/plain_read.h"

typedef struct {
    const uint64_t *words;
    size_t count;
    struct {
        uint64_t sum;
        char apart[64];
    } thread[BENCH_THREADS];
} reading;

static void read_job(void *context, unsigned thread) {
    reading *r = context;
    const uint64_t *words = r->words;
    const size_t end = r->count * (thread + 1) / BENCH_THREADS;
    uint64_t sum = 0;
    for (size_t i = r->count * thread / BENCH_THREADS; i < end; i++) sum += words[i];
    r->thread[thread].sum = sum;
}

uint64_t plain_read(bench_team *team, const void *memory, size_t bytes) {
    reading r = {.words = memory, .count = bytes / sizeof(uint64_t)};
    bench_team_run(team, read_job, &r);
    return r.thread[0].sum + r.thread[1].sum;
}
