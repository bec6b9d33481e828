/* SPDX-License-Identifier: MIT */
/* All results of a run. */
#ifndef BENCH_RESULTS_H
#define BENCH_RESULTS_H

#include "bench/bench_grids.h"
#include "bench/bench_host.h"
#include "bench/bench_machine.h"
#include "bench/bench_plugin.h"

/* All of a run. `host` and `grids` are NULL if they were not measured. Arrays are not owned. */
typedef struct {
    bench_machine machine;
    const bench_plugin_result *plugin;
    uint32_t plugin_count;
    const bench_host_result *host;
    const bench_grids_result *grids;
} bench_report;

#endif
