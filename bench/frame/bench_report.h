/* SPDX-License-Identifier: MIT */
/* The benchmark's results: a table for a person, CSV and JSON for programs. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include "frame/bench_host.h"
#include "frame/bench_plugin.h"

/* What the numbers were measured on. */
typedef struct {
    char cpu[128];
    long processors;
    char device[256], version[256], driver[128], platform[256];
    char plugin[256]; /* id and version */
    double load;      /* one-minute load average when the run began */
} bench_machine;

void bench_machine_ask(bench_machine *machine, const hs_cl *cl, const hs_plugin *plugin);

/* All of a run. `host` is NULL if it was not measured. Arrays are not owned. */
typedef struct {
    bench_machine machine;
    const bench_plugin_result *plugin;
    uint32_t plugin_count;
    const bench_host_result *host;
} bench_report;

/* The frames of method `cost` (issue "cost volume"): milliseconds at 128^3 and 171^3. 0: no limit for this
 * size. */
double bench_cost_limit_ms(uint32_t n);

/* The result of the same size, slabs and route with another method; NULL if it was not measured. */
const bench_plugin_result *bench_find(const bench_report *report, const bench_plugin_result *like,
                                      const char *method);

/* Milliseconds of a frame as multiples of a ray profile: of the mean filter's, and of its own. NAN: not
 * known. */
typedef struct {
    double mean, own;
} bench_profile_ratio;
bench_profile_ratio bench_per_profile(const bench_report *report, const bench_plugin_result *result);

/* Ratios to plain C are held to this (issue "speed"), DVR to milliseconds, the loop to volumes per second. */
#define BENCH_TARGET_RATIO   3.0
#define BENCH_TARGET_DVR_MS  60.0
#define BENCH_TARGET_VOLUMES 12.0

void bench_print_machine(const bench_machine *machine);
/* Line by line as results come in: the head before the first variant of a size, then a line each. */
void bench_print_plugin_head(uint32_t n, uint32_t k);
void bench_print_plugin(const bench_plugin_result *result);
void bench_print_stages(const bench_plugin_result *results, uint32_t count);
/* All results of a method other than the mean filter. */
void bench_print_method(const bench_report *report, const char *method);
void bench_print_host(const bench_host_result *host);
void bench_print_targets(const bench_report *report);

/* HS_ERR_OUTPUT names the path. */
bool bench_write_csv(const bench_report *report, const char *path, hs_error *err);
bool bench_write_json(const bench_report *report, const char *path, hs_error *err);

#endif
