/* SPDX-License-Identifier: MIT */
/* Exponents of how cost grows, and the Pareto front. */
#ifndef METHODS_FIT_H
#define METHODS_FIT_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    double exponent; /* b of the least-squares line log y = a + b log x */
    double factor;   /* largest ratio of a value to the line, or of the line to a value: 1 is a perfect fit */
    uint32_t count;  /* of values; with fewer than two nothing is fitted */
} methods_fit;

/* x, y > 0; values where y is 0 are left out. */
methods_fit methods_fit_line(const double *x, const double *y, uint32_t count);

/* best[i]: no other point is at least as good in both, and better in one (smaller is better). */
void methods_pareto(const double *x, const double *y, uint32_t count, bool *best);

#endif
