/* SPDX-License-Identifier: MIT */
/* What the numbers were measured on. */
#ifndef BENCH_MACHINE_H
#define BENCH_MACHINE_H

#include "plugin/loader.h"
#include "render/host_cl.h"

typedef struct {
    char cpu[128];
    long processors;
    char device[256], version[256], driver[128], platform[256];
    char plugin[256]; /* id and version */
    double load;      /* one-minute load average when the run began */
} bench_machine;

/* What cannot be asked stays empty. */
void bench_machine_ask(bench_machine *machine, const hs_cl *cl, const hs_plugin *plugin);

/* To standard output. */
void bench_machine_print(const bench_machine *machine);

#endif
