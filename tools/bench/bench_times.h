/* SPDX-License-Identifier: MIT */
/* Samples of a duration, and what is reported of them. */
#ifndef BENCH_TIMES_H
#define BENCH_TIMES_H

#include "base/error.h"

#include <stdint.h>

/* Processor time of all threads so far, milliseconds: other load on the machine
 * hardly changes what is spent. */
double bench_processor_ms(void);

typedef struct {
    double *ms;
    uint32_t count, capacity;
} bench_samples;

bool bench_samples_create(bench_samples *samples, uint32_t capacity, hs_error *err);
void bench_samples_add(bench_samples *samples, double ms);
void bench_samples_destroy(bench_samples *samples);

/* Milliseconds; zeros without samples. */
typedef struct {
    double min, median, p95; /* p95: nearest rank */
} bench_times;

/* Sorts the samples. */
bench_times bench_samples_times(bench_samples *samples);

#endif
