/* SPDX-License-Identifier: MIT */
/*
 * The spline's solver in float32 (parameter precision; the only way on devices without float64) merges to 64
 * points. What is left of its accuracy, against the same definition.
 */
#include "support/surfaces.h"

#include <math.h>

static void check(rig *r, const surface_points *p, const surface_chain *chain, double bound,
                  const char *what) {
    sv_spline_report report;
    const double error = surface_try(r, p, chain, NULL, NULL, &report);
    print_message("float32 %-9s %-24s error %.2e slices, bound %.0e\n", surface_name(chain->method), what,
                  error, bound);
    assert_true(error <= bound);
    assert_true(report.points <= 64);
}

static void test_scattered(void **state) {
    static const uint32_t sizes[][2] = {{40, 30}, {75, 40}, {128, 96}};
    for (int n = 0; n < 3; n++) {
        const uint32_t width = sizes[n][0], height = sizes[n][1];
        surface_points p = surface_points_make(width, height, 60);
        uint32_t random = 99;
        for (uint32_t i = 0; i < width * height / 20; i++) {
            const uint32_t far_end = 1 + surface_random(&random) % 59;
            surface_put(&p, surface_random(&random) % width, surface_random(&random) % height, 0, far_end);
        }
        const surface_chain spline = {
            .method = SV_METHOD_SPLINE, .float32 = true, .merge_grid = 8, .q = 0.25f};
        const surface_chain finer = {
            .method = SV_METHOD_SPLINE, .float32 = true, .merge_grid = 0, .q = 0.25f};
        check(*state, &p, &spline, 5e-3, "merged on 8 x 8");
        /* asked for every point, it merges all the same, and says so */
        sv_spline_report report;
        assert_true(isfinite(surface_try(*state, &p, &finer, NULL, NULL, &report)));
        if (width > 40) assert_int_equal(report.merge_grid, 8);
        assert_true(report.points <= 64);
    }
}

/* Collinear points, one point and clusters stay finite and near the definition in float32, too. */
static void test_degenerate(void **state) {
    for (int set = 0; set < 4; set++) {
        surface_points p = surface_points_make(50, 40, 60);
        for (uint32_t i = 0; i < 40; i += 3) {
            if (set == 0) surface_put(&p, i, 17, 0, 20 + i % 7);
            if (set == 1) surface_put(&p, i, i * 2 / 3, 0, 20 + i % 5);
            if (set == 2 && i == 18) surface_put(&p, i, 9, 0, 33);
            if (set == 3) surface_put(&p, 20 + i % 4, 12 + i / 8, 0, i % 2 ? 15 : 45);
        }
        const surface_chain spline = {.method = SV_METHOD_SPLINE, .float32 = true, .merge_grid = 8};
        check(*state, &p, &spline, 1e-2, "degenerate");
    }
}

/* In patches with wide gaps, up to 512 x 512. */
static void test_patches(void **state) {
    static const uint32_t sides[] = {128, 171, 512};
    for (int n = 0; n < 3; n++) {
        surface_points p = surface_patches(sides[n], sides[n], 60, 7);
        const surface_chain spline = {.method = SV_METHOD_SPLINE, .float32 = true, .merge_grid = 8};
        check(*state, &p, &spline, 1e-2, "patches");
    }
}

UNIT_MAIN(rig_setup, rig_teardown, cmocka_unit_test(test_scattered), cmocka_unit_test(test_degenerate),
          cmocka_unit_test(test_patches))
