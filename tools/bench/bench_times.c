/* SPDX-License-Identifier: MIT */
#include "bench/bench_times.h"

#include <stdlib.h>
#include <time.h>

double bench_processor_ms(void) {
    struct timespec t;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

bool bench_samples_create(bench_samples *samples, uint32_t capacity, hs_error *err) {
    *samples = (bench_samples){.ms = malloc(capacity * sizeof(double)), .capacity = capacity};
    return samples->ms || hs_fail(err, HS_ERR_MEMORY, "benchmark: no memory for %u samples", capacity);
}

void bench_samples_add(bench_samples *samples, double ms) {
    if (samples->count < samples->capacity) samples->ms[samples->count++] = ms;
}

void bench_samples_destroy(bench_samples *samples) {
    free(samples->ms);
    *samples = (bench_samples){0};
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_times bench_samples_times(bench_samples *samples) {
    const uint32_t n = samples->count;
    if (n == 0) return (bench_times){0};
    qsort(samples->ms, n, sizeof(double), compare);
    const double median = (samples->ms[(n - 1) / 2] + samples->ms[n / 2]) / 2.0;
    return (bench_times){samples->ms[0], median, samples->ms[(n * 95 + 99) / 100 - 1]};
}
