/* SPDX-License-Identifier: MIT */
/* A small dense solver: Gaussian elimination with partial pivoting. */
#ifndef SV_REF_SOLVE_H
#define SV_REF_SOLVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Factors a (n x n, row by row) in place; false if it is singular to working precision. */
bool sv_ref_factor(double *a, uint32_t n, uint32_t *pivots);
/* Solves with the factors; b becomes the solution. */
void sv_ref_solve(const double *a, uint32_t n, const uint32_t *pivots, double *b);
/* Estimate of the inverse's 1-norm for a symmetric matrix (Hager's method). `work`: 3 n values. */
double sv_ref_inverse_norm(const double *a, uint32_t n, const uint32_t *pivots, double *work);

#endif
