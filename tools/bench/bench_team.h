/* SPDX-License-Identifier: MIT */
/* Two persistent threads, the caller and one more, for the C side of the benchmark. */
#ifndef BENCH_TEAM_H
#define BENCH_TEAM_H

#include "base/error.h"

enum { BENCH_THREADS = 2 };

typedef struct bench_team bench_team;

/* NULL with HS_ERR_MEMORY if the thread cannot be started. */
bench_team *bench_team_create(hs_error *err);
void bench_team_destroy(bench_team *team);

/* Wakes the second thread and returns once it runs, so that a bench_team_run right after measures work and
 * not the system's wake-up. bench_team_rest lets it sleep at once; otherwise it would look for work some 50
 * us more, and take a core from others. */
void bench_team_ready(bench_team *team);
void bench_team_rest(bench_team *team);

/* Runs job(context, 0) here and job(context, 1) on the second thread, and returns when both have. Only
 * between ready and rest. */
void bench_team_run(bench_team *team, void (*job)(void *context, unsigned thread), void *context);

/* For jobs: returns when both threads have called it; what either wrote before is seen by both. */
void bench_team_barrier(bench_team *team);

#endif
