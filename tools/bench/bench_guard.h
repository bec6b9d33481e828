/* SPDX-License-Identifier: MIT */
/* What the guard costs a frame: the same frames with the plugin in this process and in one of its own, in
 * turns. */
#ifndef BENCH_GUARD_H
#define BENCH_GUARD_H

#include "bench/bench_times.h"
#include "render/host_cl.h"
#include "smartvis_plugin.h"

typedef struct {
    const char *path, *id; /* of the plugin */
    const hs_cl *cl;
    uint32_t frames;
    const sv_param_value *values;
    uint32_t value_count;
} bench_guard_setup;

enum { BENCH_DIRECT, BENCH_GUARDED, BENCH_GUARD_WAYS };

typedef struct {
    uint32_t n;                            /* voxels an axis of the low-resolution volume */
    bench_times convert[BENCH_GUARD_WAYS]; /* scan conversion into the slabs */
    bench_times plugin[BENCH_GUARD_WAYS];  /* begin to the depthmap on the host's device, checked */
} bench_guard_result;

/* HS_ERR_FAILED if the two maps differ. HS_ERR_PLUGIN, HS_ERR_DEVICE, HS_ERR_MEMORY. */
bool bench_guard_run(const bench_guard_setup *setup, uint32_t n, bench_guard_result *result, hs_error *err);

/* A heading, and a line a size. */
void bench_guard_print_head(void);
void bench_guard_print(const bench_guard_result *result);

#endif
