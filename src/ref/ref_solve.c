/* SPDX-License-Identifier: MIT */
/* A small dense solver: LU with partial pivoting, and Hager's estimate of the inverse's norm. */
#include "ref/ref_solve.h"

#include <float.h>
#include <math.h>

static void swap_rows(double *a, uint32_t n, uint32_t i, uint32_t j) {
    for (uint32_t c = 0; c < n; c++) {
        const double keep = a[(size_t)i * n + c];
        a[(size_t)i * n + c] = a[(size_t)j * n + c];
        a[(size_t)j * n + c] = keep;
    }
}

static double largest_of(const double *a, size_t count) {
    double largest = 0.0;
    for (size_t i = 0; i < count; i++) largest = fmax(largest, fabs(a[i]));
    return largest;
}

bool sv_ref_factor(double *a, uint32_t n, uint32_t *pivots) {
    const double least = largest_of(a, (size_t)n * n) * DBL_EPSILON * n;
    for (uint32_t k = 0; k < n; k++) {
        uint32_t best = k;
        for (uint32_t i = k + 1; i < n; i++)
            if (fabs(a[(size_t)i * n + k]) > fabs(a[(size_t)best * n + k])) best = i;
        pivots[k] = best;
        if (fabs(a[(size_t)best * n + k]) <= least) return false;
        if (best != k) swap_rows(a, n, best, k);
        for (uint32_t i = k + 1; i < n; i++) {
            const double factor = a[(size_t)i * n + k] / a[(size_t)k * n + k];
            a[(size_t)i * n + k] = factor;
            for (uint32_t c = k + 1; c < n; c++) a[(size_t)i * n + c] -= factor * a[(size_t)k * n + c];
        }
    }
    return true;
}

void sv_ref_solve(const double *a, uint32_t n, const uint32_t *pivots, double *b) {
    for (uint32_t k = 0; k < n; k++) {
        const double keep = b[k];
        b[k] = b[pivots[k]];
        b[pivots[k]] = keep;
    }
    for (uint32_t i = 1; i < n; i++)
        for (uint32_t c = 0; c < i; c++) b[i] -= a[(size_t)i * n + c] * b[c];
    for (uint32_t i = n; i-- > 0;) {
        for (uint32_t c = i + 1; c < n; c++) b[i] -= a[(size_t)i * n + c] * b[c];
        b[i] /= a[(size_t)i * n + i];
    }
}

/* The convex function x -> |inverse x|_1 on the unit ball, climbed along its gradient: at most five steps. */
double sv_ref_inverse_norm(const double *a, uint32_t n, const uint32_t *pivots, double *work) {
    double *x = work, *signs = work + n, norm = 0.0;
    for (uint32_t i = 0; i < n; i++) x[i] = 1.0 / n;
    for (int step = 0; step < 5; step++) {
        sv_ref_solve(a, n, pivots, x);
        double sum = 0.0;
        for (uint32_t i = 0; i < n; i++) {
            sum += fabs(x[i]);
            signs[i] = x[i] < 0.0 ? -1.0 : 1.0;
        }
        if (sum <= norm) return norm;
        norm = sum;
        sv_ref_solve(a, n, pivots, signs); /* symmetric: the transposed inverse is the inverse */
        uint32_t best = 0;
        for (uint32_t i = 1; i < n; i++)
            if (fabs(signs[i]) > fabs(signs[best])) best = i;
        for (uint32_t i = 0; i < n; i++) x[i] = i == best ? 1.0 : 0.0;
    }
    return norm;
}
