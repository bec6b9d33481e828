/* SPDX-License-Identifier: MIT */
/* What the parts of the benchmark share: machine, times, two threads, slabs. */
#pragma once

#include "core/error.h"
#include "guarded/guard_options.h"
#include "loop/loop_run.h"
#include "plugin/loader.h"
#include "render/host_kernels.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* --------------------------------------------------------------------------------------------- machine -- */
/* What the numbers were measured on. */

typedef struct {
    char cpu[128];
    long processors;
    char device[256], version[256], driver[128], platform[256];
    char plugin[256]; /* id and version */
    double load;      /* one-minute load average when the run began */
} bench_machine;

/* What cannot be asked stays empty. */
void bench_machine_ask(bench_machine *machine, const hs_cl *cl, const hs_plugin *plugin);

/* Prints the machine to standard output. */
void bench_machine_print(const bench_machine *machine);

/* ----------------------------------------------------------------------------------------------- times -- */
/* Samples of a duration, and what is reported of them. */

typedef struct {
    double *ms;
    uint32_t count, capacity;
} bench_samples;

bool bench_samples_create(bench_samples *samples, uint32_t capacity, hs_error *err);
void bench_samples_add(bench_samples *samples, double ms);
void bench_samples_destroy(bench_samples *samples);

/* Sorts the samples. */
hs_timing bench_samples_times(const bench_samples *samples);

/* ----------------------------------------------------------------------------------------- two threads -- */

enum { BENCH_THREADS = 2 };

/* Zeroed: nobody waits. */
typedef struct {
    atomic_uint arrived, phase, sleepers;
} bench_barrier;

/* Returns when both threads have called it; what either wrote before is seen by both. */
void bench_barrier_wait(bench_barrier *barrier);

/* Runs job(context, 0) here and job(context, 1) on a second thread, and returns when both are through. The
 * milliseconds are those of the job: the second thread is awake before the clock starts. HS_ERR_MEMORY if it
 * cannot be started. */
bool bench_two_run(void (*job)(void *context, unsigned thread), void *context, double *ms, hs_error *err);

/* --------------------------------------------------------------------------------------------- volumes -- */
/*
 * The yardsticks: what a careful C programmer gets from two threads and the compiler's vectoriser, -O3
 * -march=native, without intrinsics. For the benchmark only; it shares no code with the plugin.
 */

/* A volume as slices in tiles: voxel (x, y, z) is slice[z][y * pitch + x]. Not owned. After every row 63
 * bytes more may be read; they do not matter. */
typedef struct {
    uint32_t width, height, slices;
    const uint8_t **slice;
    size_t pitch; /* bytes */
} plain_volume;

/* Intensities of the benchmark's volume, grey levels: fluid 1 .. 40, tissue 60 .. 150, bone 220 .. 255. */
enum { BENCH_FLUID_LEVEL = 40 };

/* n voxels an axis, x fastest, then y. The same voxels at every call: a wall, fluid, then tissue with bones
 * that 3 % of the rays meet; a few rays meet bone in the wall, before any fluid. All layers have noise. The
 * caller frees them; NULL with HS_ERR_MEMORY. */
uint8_t *bench_volume_make(uint32_t n, hs_error *err);
