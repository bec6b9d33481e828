/* SPDX-License-Identifier: MIT */
/*
 * The spline solver: against LAPACK (dgesv on the whole matrix of Eq. 3.8) up to the most
 * points it takes, and on the sets that defeat LU without pivoting (thesis 5.2: clusters,
 * collinear and nearly coincident points).
 */
#include "support/surfaces.h"

#include "ref/ref_spline.h"

#include <lapacke.h>

#include <math.h>

static const double BOUND = 1e-3; /* slices, as docs/numerics.md says */

/* `count` different pixels; depths on a smooth hill with some noise, as skin is. */
static surface_points hill(uint32_t width, uint32_t height, uint32_t count, uint32_t seed) {
    surface_points p = surface_points_make(width, height, 80);
    uint32_t random = seed * 2654435761u + 1;
    for (uint32_t n = 0; n < count;) {
        const uint32_t x = unit_random(&random) % width, y = unit_random(&random) % height;
        if (p.status[(size_t)y * width + x]) continue;
        const double height_here = 40.0 + 15.0 * sin(x * 0.05) * cos(y * 0.04);
        const uint32_t far_end = (uint32_t)height_here + unit_random(&random) % 3;
        surface_put(&p, x, y, far_end / 2, far_end);
        n++;
    }
    return p;
}

/* The spline through the far ends (q = 0) by LAPACK, at every pixel. */
static double *lapack_surface(const surface_points *p, uint32_t count, double lambda) {
    const size_t n = count, size = n + 3, pixels = (size_t)p->width * p->height;
    double *m = unit_memory(size * size * sizeof *m), *b = unit_memory(size * sizeof *b);
    double *x = unit_memory(n * sizeof *x), *y = unit_memory(n * sizeof *y),
           *surface = unit_memory(pixels * sizeof *surface);
    lapack_int *pivots = unit_memory(size * sizeof *pivots);
    size_t k = 0;
    for (size_t i = 0; i < pixels; i++)
        if (p->status[i]) {
            x[k] = (double)(i % p->width);
            y[k] = (double)(i / p->width);
            b[k++] = p->far_end[i];
        }
    assert_int_equal(k, n);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++)
            m[i * size + j] = sv_ref_phi((x[i] - x[j]) * (x[i] - x[j]) + (y[i] - y[j]) * (y[i] - y[j]));
        m[i * size + i] += lambda;
        m[i * size + n] = m[n * size + i] = 1.0;
        m[i * size + n + 1] = m[(n + 1) * size + i] = x[i];
        m[i * size + n + 2] = m[(n + 2) * size + i] = y[i];
    }
    assert_int_equal(LAPACKE_dgesv(LAPACK_ROW_MAJOR, (lapack_int)size, 1, m, (lapack_int)size, pivots, b, 1),
                     0);
    for (size_t i = 0; i < pixels; i++) {
        const double u = (double)(i % p->width), v = (double)(i / p->width);
        surface[i] = b[n] + b[n + 1] * u + b[n + 2] * v;
        for (size_t j = 0; j < n; j++)
            surface[i] += b[j] * sv_ref_phi((u - x[j]) * (u - x[j]) + (v - y[j]) * (v - y[j]));
    }
    return surface;
}

static void test_lapack(void **state) {
    static const uint32_t counts[] = {4, 10, 33, 64, 200, 700, 1400};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        for (double lambda = 0.0; lambda <= 50.0; lambda += 50.0) {
            surface_points p = hill(128, 96, counts[i], 9 + (uint32_t)i);
            const surface_chain chain = {.method = SV_METHOD_SPLINE, .lambda = lambda};
            const double *expected = lapack_surface(&p, counts[i], lambda);
            const double error = surface_try(*state, &p, &chain, expected, NULL);
            print_message("%4u points, lambda %2.0f: error against LAPACK %.2e slices\n", counts[i], lambda,
                          error);
            assert_true(error <= BOUND);
        }
}

/* The reference solver itself against LAPACK. */
static void test_reference_solver(void **state) {
    enum { N = 60 };
    static double a[N * N], lu[N * N], b[N], x[N];
    static uint32_t pivots[N];
    static lapack_int order[N];
    uint32_t random = 4711;
    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++) a[i * N + j] = a[j * N + i] = unit_random(&random) / 4294967296.0 - 0.5;
    for (int i = 0; i < N; i++) {
        a[i * N + i] = 0.0; /* what LU without pivoting cannot begin with */
        b[i] = x[i] = i % 7 - 3.0;
    }
    for (int i = 0; i < N * N; i++) lu[i] = a[i];
    assert_true(sv_ref_factor(lu, N, pivots));
    sv_ref_solve(lu, N, pivots, x);
    assert_int_equal(LAPACKE_dgetrf(LAPACK_ROW_MAJOR, N, N, a, N, order), 0);
    assert_int_equal(LAPACKE_dgetrs(LAPACK_ROW_MAJOR, 'N', N, 1, a, N, order, b, 1), 0);
    for (int i = 0; i < N; i++) assert_true(fabs(x[i] - b[i]) <= 1e-10);
    static double singular[4] = {1.0, 2.0, 2.0, 4.0};
    assert_false(sv_ref_factor(singular, 2, pivots));
}

/* The solver in float32 (parameter precision; the only way on devices without float64) merges on 8 x 8 cells,
 * also where it is asked for all points. What is left of its accuracy, against the same definition. */
static void check_float32(rig *r, const surface_points *p, uint32_t merge, double bound, const char *what) {
    const surface_chain chain = {
        .method = SV_METHOD_SPLINE, .float32 = true, .merge_grid = merge, .q = 0.25f};
    const surface_chain merged = {.method = SV_METHOD_SPLINE, .merge_grid = 8, .q = 0.25f};
    const double error = surface_try(r, p, &chain, surface_expect(p, &merged), NULL);
    print_message("float32, %-24s error %.2e slices, bound %.0e\n", what, error, bound);
    assert_true(error <= bound);
}

/* A degenerate set: a surface that meets the definition. */
static void check_set(rig *r, const surface_points *p, const char *what) {
    const surface_chain chain = {.method = SV_METHOD_SPLINE};
    const double error = surface_try(r, p, &chain, NULL, NULL);
    print_message("%-28s error %.2e slices\n", what, error);
    assert_true(error <= BOUND);
    check_float32(r, p, 8, 1e-2, what);
}

static void test_degenerate(void **state) {
    surface_points one = surface_points_make(50, 40, 60), two = surface_points_make(50, 40, 60);
    surface_points row = surface_points_make(50, 40, 60), slant = surface_points_make(50, 40, 60);
    surface_points nearly = surface_points_make(50, 40, 60), clump = surface_points_make(50, 40, 60);
    surface_put(&one, 13, 9, 5, 20);
    surface_put(&two, 3, 9, 5, 20);
    surface_put(&two, 41, 30, 5, 50);
    for (uint32_t i = 0; i < 40; i += 3) {
        surface_put(&row, i, 17, 5, 20 + i % 7);
        surface_put(&slant, i, i * 2 / 3, 5, 20 + i % 5);
        surface_put(&nearly, i, i == 18 ? 18 : 17, 5, 20 + i % 7);
    }
    for (uint32_t y = 0; y < 12; y++) /* Figure 5.1: clusters of unlike depths, side by side */
        for (uint32_t x = 0; x < 24; x++) surface_put(&clump, 10 + x, 12 + y, 2, x < 12 ? 15 : 45);
    check_set(*state, &one, "one point");
    check_set(*state, &two, "two points");
    check_set(*state, &row, "collinear, level");
    check_set(*state, &slant, "collinear, slanting");
    check_set(*state, &nearly, "collinear but for one pixel");
    check_set(*state, &clump, "two unlike clusters");
}

/* More points than the solver takes are merged, as the definition does it. */
static void test_too_many(void **state) {
    surface_points p = hill(90, 80, 1401, 77);
    const surface_chain chain = {.method = SV_METHOD_SPLINE};
    assert_true(surface_try(*state, &p, &chain, NULL, NULL) <= BOUND);
    check_float32(*state, &p, 0, 1e-2, "merged unasked");
}

/* The coarse grid costs what bilinear interpolation costs: against the spline itself, on the hill above. */
static void test_coarse_grid(void **state) {
    surface_points p = hill(128, 128, 300, 5);
    const surface_chain fine = {.method = SV_METHOD_SPLINE, .merge_grid = 8};
    double *expected = surface_expect(&p, &fine);
    double before = INFINITY;
    for (uint32_t grid = 16; grid <= 64; grid *= 2) {
        const surface_chain coarse = {.method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = grid};
        const double error = surface_try(*state, &p, &coarse, expected, NULL);
        print_message("coarse grid %2u: error %.3f slices\n", grid, error);
        assert_true(error < 0.5 * before); /* second order: twice as fine, a quarter of the error or so */
        if (grid == 32) assert_true(error <= 0.3); /* docs/numerics.md */
        before = error;
    }
}

/*
 * On any set of points: what bilinear interpolation between nodes h pixels apart may cost a spline with
 * weights w_j (docs/numerics.md): h^2 / 4 * max(13, 2 ln(R / h) + 3) * sum |w_j|, R the map's diagonal.
 */
static double grid_bound(const surface_points *p, const sv_ref_spline *spline, uint32_t grid) {
    const double side = fmax(p->width - 1.0, p->height - 1.0), h = side / grid;
    const double diagonal = hypot(p->width - 1.0, p->height - 1.0);
    double sum = 0.0;
    for (uint32_t j = 0; j < spline->count; j++) sum += fabs(spline->w[j]);
    return h * h / 4.0 * fmax(13.0, 2.0 * log(diagonal / h) + 3.0) * sum;
}

static void check_grids(rig *r, const surface_points *p, const char *what) {
    const size_t count = (size_t)p->width * p->height;
    const sv_ref_map map = {.status = p->status, .depth = p->far_end, .width = p->width, .height = p->height};
    const surface_chain fine = {.method = SV_METHOD_SPLINE, .merge_grid = 8};
    double *x = unit_memory(3 * count * sizeof *x), *expected = surface_expect(p, &fine);
    sv_ref_spline spline;
    const uint32_t n = sv_ref_merge(&map, 8, x, x + count, x + 2 * count);
    assert_true(sv_ref_spline_solve(x, x + count, x + 2 * count, n, 0.0, &spline));
    for (uint32_t grid = 16; grid <= 64; grid *= 2) {
        const surface_chain coarse = {.method = SV_METHOD_SPLINE, .merge_grid = 8, .spline_grid = grid};
        const double error = surface_try(r, p, &coarse, expected, NULL);
        const double bound = grid_bound(p, &spline, grid);
        print_message("coarse grid %2u, %-9s %3u x %-3u error %.3f slices, bound %.2f\n", grid, what,
                      p->width, p->height, error, bound);
        assert_true(error <= bound);
        if (grid == 32) assert_true(error <= 2.0); /* docs/numerics.md: depths of 60 slices */
    }
    sv_ref_spline_free(&spline);
}

static void test_coarse_grid_anywhere(void **state) {
    static const uint32_t sides[] = {128, 171, 512};
    for (int n = 0; n < 3; n++) {
        surface_points patches = surface_patches(sides[n], sides[n], 60, 7);
        surface_points scattered = surface_scattered(sides[n], sides[n], 60, sides[n] * sides[n] / 33, 71);
        check_grids(*state, &patches, "patches");
        check_grids(*state, &scattered, "scattered");
        check_float32(*state, &patches, 8, 1e-2, "patches");
        check_float32(*state, &scattered, 8, 5e-3, "scattered");
    }
}

UNIT_MAIN(rig_setup, rig_teardown, test_lapack, test_reference_solver, test_degenerate, test_too_many,
          test_coarse_grid, test_coarse_grid_anywhere)
