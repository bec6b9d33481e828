/* SPDX-License-Identifier: MIT */
/* The frames of another method than the one plain C computes, as multiples of a ray profile. */
#ifndef BENCH_METHOD_H
#define BENCH_METHOD_H

#include "bench/bench_results.h"

/* A method that is timed beside the mean filter. */
typedef struct {
    const char *name;
    double limit_ms[2]; /* what a frame may take at 128^3 and at 171^3, milliseconds */
    uint32_t largest;   /* voxels an axis of the largest volume that it is timed on */
} bench_method;

enum { BENCH_METHODS = 2 };
extern const bench_method bench_methods[BENCH_METHODS];

/* What a frame may take, in milliseconds; 0: this size has no limit. */
double bench_limit_ms(const bench_method *method, uint32_t n);

/* The result of the same size, slabs and route with another method; NULL if it was not measured. */
const bench_plugin_result *bench_find(const bench_report *report, const bench_plugin_result *like,
                                      const char *method);

/* Milliseconds of a frame as multiples of a ray profile: of the mean filter's,
 * and of its own. NAN: not known. */
typedef struct {
    double mean, own;
} bench_profile_ratio;
bench_profile_ratio bench_per_profile(const bench_report *report, const bench_plugin_result *result);

/* Prints all results of a method other than the mean filter. */
void bench_print_method(const bench_report *report, const char *method);

#endif
