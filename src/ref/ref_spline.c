/* SPDX-License-Identifier: MIT */
#include "ref/ref_spline.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

double sv_ref_phi(double r_squared) {
    return r_squared > 0.0 ? 0.5 * r_squared * log(r_squared) : 0.0;
}

/* Coordinates of the plane: column c of P at (x, y). */
static double plane_term(const sv_ref_spline *s, uint32_t c, double x, double y) {
    const double dx = x - s->mean_x, dy = y - s->mean_y;
    if (c == 0) return 1.0;
    return c == 1 ? s->axis_x * dx + s->axis_y * dy : s->axis_x * dy - s->axis_y * dx;
}

/* Mean, main axis, and how many of the plane's three columns the points determine. */
static void find_plane(sv_ref_spline *s) {
    double xx = 0.0, xy = 0.0, yy = 0.0, along = 0.0, across = 0.0;
    for (uint32_t i = 0; i < s->count; i++) {
        s->mean_x += s->x[i] / s->count;
        s->mean_y += s->y[i] / s->count;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        const double dx = s->x[i] - s->mean_x, dy = s->y[i] - s->mean_y;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    const double angle = 0.5 * atan2(2.0 * xy, xx - yy);
    s->axis_x = cos(angle);
    s->axis_y = sin(angle);
    for (uint32_t i = 0; i < s->count; i++) {
        along = fmax(along, fabs(plane_term(s, 1, s->x[i], s->y[i])));
        across = fmax(across, fabs(plane_term(s, 2, s->x[i], s->y[i])));
    }
    s->rank = along == 0.0 ? 1 : across <= 1e-12 * along ? 2 : 3;
}

/* The matrix of Eq. 3.8 with lambda on the diagonal of K (Eq. 3.15). */
static void fill_matrix(const sv_ref_spline *s, double lambda, double *m) {
    const size_t n = s->count, size = n + s->rank;
    memset(m, 0, size * size * sizeof *m);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            const double dx = s->x[i] - s->x[j], dy = s->y[i] - s->y[j];
            m[i * size + j] = sv_ref_phi(dx * dx + dy * dy) + (i == j ? lambda : 0.0);
        }
        for (uint32_t c = 0; c < s->rank; c++)
            m[i * size + n + c] = m[(n + c) * size + i] = plane_term(s, c, s->x[i], s->y[i]);
    }
}

/* Largest column sum of magnitudes. */
static double matrix_norm(const double *m, size_t size) {
    double norm = 0.0;
    for (size_t i = 0; i < size; i++) {
        double sum = 0.0;
        for (size_t j = 0; j < size; j++) sum += fabs(m[i * size + j]); /* symmetric */
        norm = fmax(norm, sum);
    }
    return norm;
}

static void measure_residual(sv_ref_spline *s, const double *z, double lambda) {
    s->residual = 0.0;
    for (uint32_t i = 0; i < s->count; i++)
        s->residual =
            fmax(s->residual, fabs(sv_ref_spline_at(s, s->x[i], s->y[i]) + lambda * s->w[i] - z[i]));
}

bool sv_ref_spline_solve(const double *x, const double *y, const double *z, uint32_t count, double lambda,
                         sv_ref_spline *out) {
    *out = (sv_ref_spline){.count = count};
    if (count == 0) return true;
    out->x = malloc(3 * (size_t)count * sizeof *out->x);
    if (!out->x) return false;
    out->y = out->x + count;
    out->w = out->y + count;
    memcpy(out->x, x, count * sizeof *x);
    memcpy(out->y, y, count * sizeof *y);
    find_plane(out);
    const uint32_t size = count + out->rank;
    double *m = malloc(((size_t)size * size + 4 * (size_t)size) * sizeof *m);
    uint32_t *pivots = malloc(size * sizeof *pivots);
    if (m && pivots) {
        double *b = m + (size_t)size * size;
        fill_matrix(out, lambda, m);
        const double norm = matrix_norm(m, size);
        out->singular = !sv_ref_factor(m, size, pivots);
        for (uint32_t i = 0; i < size; i++) b[i] = i < count ? z[i] : 0.0;
        if (!out->singular) {
            sv_ref_solve(m, size, pivots, b);
            out->condition = norm * sv_ref_inverse_norm(m, size, pivots, b + size);
        }
        memcpy(out->w, b, count * sizeof *b);
        for (uint32_t c = 0; c < out->rank; c++) out->plane[c] = b[count + c];
        if (!out->singular) measure_residual(out, z, lambda);
    }
    const bool ok = m && pivots;
    free(m);
    free(pivots);
    if (!ok) sv_ref_spline_free(out);
    return ok;
}

double sv_ref_spline_at(const sv_ref_spline *s, double x, double y) {
    double sum = 0.0;
    for (uint32_t c = 0; c < s->rank; c++) sum += s->plane[c] * plane_term(s, c, x, y);
    for (uint32_t i = 0; i < s->count; i++) {
        const double dx = x - s->x[i], dy = y - s->y[i];
        sum += s->w[i] * sv_ref_phi(dx * dx + dy * dy);
    }
    return sum;
}

void sv_ref_spline_free(sv_ref_spline *s) {
    free(s->x);
    s->x = NULL;
}
