/* SPDX-License-Identifier: MIT */
/* The benchmark's results as tables on standard output. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include "bench/bench_results.h"

/* Ratios to plain C are held to this (issue "speed"), DVR to milliseconds, the loop to volumes per second. */
#define BENCH_TARGET_RATIO   3.0
#define BENCH_TARGET_DVR_MS  60.0
#define BENCH_TARGET_VOLUMES 12.0

/* Line by line as results come in: the head before the first variant of a size, then a line each. */
void bench_print_plugin_head(uint32_t n, uint32_t k);
void bench_print_plugin(const bench_plugin_result *result);
void bench_print_stages(const bench_plugin_result *results, uint32_t count);
void bench_print_host(const bench_host_result *host);
void bench_print_targets(const bench_report *report);

#endif
