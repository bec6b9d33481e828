/* SPDX-License-Identifier: MIT */
/* Times scan conversion against reading the volume's bytes once, and holds it to exact means over boxes. */
#ifndef BENCH_CONVERT_H
#define BENCH_CONVERT_H

#include "bench/bench_team.h"
#include "bench/bench_times.h"
#include "eval/eval_box.h"

enum { BENCH_CONVERT_VIEWS = 5 };

typedef struct {
    bench_times wall, processor; /* processor: of all threads */
} bench_convert_time;

/* One camera. Milliseconds, all from the same turns. */
typedef struct {
    const char *label;
    bench_convert_time read;  /* two threads read the volume's bytes once */
    bench_convert_time fresh; /* of a volume that has just arrived: with all that is made of it */
    bench_convert_time again; /* of the same volume once more, as for a camera that moves */
    uint32_t size[3];         /* low-resolution voxels */
    hs_box_error error;
} bench_convert_view;

typedef struct {
    char volume[256]; /* its name */
    size_t bytes;
    bench_convert_view view[BENCH_CONVERT_VIEWS];
} bench_convert_result;

typedef struct {
    const hs_cl *cl;
    bench_team *team;
    uint32_t frames;
} bench_convert_setup;

/* A third of the source's resolution, cubic, slabs of 16, from several cameras. `volume` may be in probe
 * geometry; NULL: none could be had, and `err` says why. HS_ERR_*. */
bool bench_convert_run(const bench_convert_setup *setup, const hs_volume *volume, bench_convert_result *out,
                       hs_error *err);
void bench_print_convert(const bench_convert_result *result);

#endif
