/* The benchmark's results: a table for a person, CSV and JSON for programs. */
#ifndef BENCH_REPORT_H
#define BENCH_REPORT_H

#include "bench_host.h"
#include "bench_plugin.h"

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

/* Ratios to plain C are held to this (issue "speed"), DVR to milliseconds, the loop to volumes per second. */
#define BENCH_TARGET_RATIO   3.0
#define BENCH_TARGET_DVR_MS  60.0
#define BENCH_TARGET_VOLUMES 12.0

void bench_print_machine(const bench_machine *machine);
/* Line by line as results come in: the head before the first variant of a size, then a line each. */
void bench_print_plugin_head(uint32_t n, uint32_t k);
void bench_print_plugin(const bench_plugin_result *result);
void bench_print_stages(const bench_plugin_result *results, uint32_t count);
void bench_print_host(const bench_host_result *host);
void bench_print_targets(const bench_report *report);

/* HS_ERR_OUTPUT names the path. */
bool bench_write_csv(const bench_report *report, const char *path, hs_error *err);
bool bench_write_json(const bench_report *report, const char *path, hs_error *err);

#endif
