/* SPDX-License-Identifier: MIT */
/* Times the renderer's two looks in turns, so that other load on the machine affects both alike. */
#ifndef BENCH_LIT_H
#define BENCH_LIT_H

#include "bench/bench_picture.h"
#include "bench/bench_times.h"

/* One camera, clipped at a plane in the fluid or not. Milliseconds of a picture of 512 x 512. */
typedef struct {
    const char *label;
    bench_times thesis, lit;
} bench_lit_view;

typedef struct {
    bench_lit_view view[BENCH_VIEWS];
    bench_times volume; /* what the lit look makes of a new volume */
} bench_lit_result;

bool bench_lit_run(const hs_cl *cl, const hs_volume *volume, uint32_t frames, bench_lit_result *out,
                   hs_error *err);

/* The table, with the ratios of medians and of minima. */
void bench_print_lit(const bench_lit_result *result);

#endif
