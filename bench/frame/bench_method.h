/* SPDX-License-Identifier: MIT */
/* The frames of another method than the one plain C computes, as multiples of a ray profile. */
#ifndef BENCH_METHOD_H
#define BENCH_METHOD_H

#include "frame/bench_results.h"

/* Methods that are timed beside the mean filter. */
enum { BENCH_METHODS = 2 };
extern const char *const bench_methods[BENCH_METHODS];

/* What a frame with such a method may take, in milliseconds; 0: no limit for the method or for this size. */
double bench_limit_ms(const char *method, uint32_t n);

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
