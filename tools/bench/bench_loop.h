/* SPDX-License-Identifier: MIT */
/* The whole loop as a scan runs it: a turned camera, a new volume every frame, a
 * method of the plugin's, lit. */
#ifndef BENCH_LOOP_H
#define BENCH_LOOP_H

#include "bench/bench_host.h"
#include "bench/bench_team.h"

enum { BENCH_LOOP_METHODS = 3 };
#define BENCH_LOOP_TARGET 20.0 /* volumes a second */

/* One method. Milliseconds of frames that were taken in turns. */
typedef struct {
    const char *method;
    bench_times stage[HS_STAGE_COUNT]; /* lit, stage by stage */
    bench_times unlit;                 /* the whole loop in the thesis' look */
    bench_times flow;                  /* the whole loop, lit, without waits between its stages */
    bench_times processor;             /* processor time of a frame of `flow`, of all threads */
    bench_times read;                  /* two threads read the volume's bytes once */
    bench_times read_processor;
    uint32_t clipped, frames;
} bench_loop_row;

typedef struct {
    bench_loop_row row[BENCH_LOOP_METHODS];
    uint32_t count;
} bench_loop_result;

/* The methods mean, cost and wall, as far as the plugin has them; a plugin without methods as it is.
 * HS_ERR_*. */
bool bench_loop_run(const bench_host_setup *setup, bench_team *team, const hs_source *source,
                    bench_loop_result *out, hs_error *err);
void bench_print_loop(const bench_loop_result *result);

#endif
