/* SPDX-License-Identifier: MIT */
/*
 * The mean filter with planes of 16 bits (precision int16): equal to its scalar form bit for bit, in every
 * layout, and within the bound that follows from the passes and the step: passes * (2^-(f + 1) + depth *
 * 2^-23), f as large as 16 bits leave (docs/numerics.md).
 */
#include "support/compare.h"
#include "support/surfaces.h"
#include "support/unit.h"

#include <math.h>

enum { INT16 = 2 };

static void in_all_layouts(rig *r, rig_format f, const uint8_t *volume, rig_settings s, const char *where,
                           compare_summary *summary) {
    s.half = true;
    for (uint32_t strategy = 1; strategy <= 3; strategy++) {
        f.fixed[0] = (sv_param_value){rig_param(r, "strategy"), 0, strategy};
        f.fixed[1] = (sv_param_value){rig_param(r, "substeps"), 0, s.substeps};
        f.fixed[2] = (sv_param_value){rig_param(r, "precision"), 0, INT16};
        compare_run(r, &f, volume, &s, where, summary);
    }
}

/* Every kind of volume, weight and sampling. */
static void test_volumes(void **state) {
    static const double omegas[] = {0.25, 0.5, 1.0, 0.0};
    static const uint32_t sizes[][3] = {{75, 41, 60}, {16, 33, 200}, {130, 24, 31}, {1, 1, 9}};
    compare_summary all = {0};
    for (uint32_t n = 0; n < 16; n++) {
        const uint32_t *size = sizes[n % 4];
        const rig_format f = {.width = size[0],
                              .height = size[1],
                              .slices = size[2],
                              .slab_slices = 16,
                              .padding = SV_NO_PADDING};
        rig_settings s = rig_default_settings();
        s.omega = omegas[n / 4];
        s.substeps = 1 + n % 4;
        s.k = 3 + 2 * (7 * n % 31);
        s.q = 0.1f * (float)n;
        uint8_t *volume =
            rig_volume((rig_kind)((n + n / 4) % RIG_KIND_COUNT), size[0], size[1], size[2], n + 1);
        in_all_layouts(*state, f, volume, s, "16-bit planes", &all);
        free(volume);
    }
    compare_print("16-bit planes", &all);
    assert_int_equal(all.frames, 48);
    assert_true(all.max_passes > 5);
}

/* Nothing overflows: every pixel at the largest depth, with the largest weight and window. */
static void test_largest(void **state) {
    static const uint32_t depths[] = {2, 60, 512, 8192};
    for (int n = 0; n < 4; n++)
        for (int q = 0; q < 2; q++) {
            const uint32_t side = depths[n] > 1000 ? 6 : 70, last = depths[n] - 1;
            int32_t *ends = calloc((size_t)2 * side * side, sizeof *ends);
            assert_non_null(ends);
            for (uint32_t i = 0; i < side * side; i++) ends[side * side + i] = (int32_t)last;
            const rig_format f = {
                .width = side, .height = side, .slices = depths[n], .tiles_x = 1, .padding = SV_NO_PADDING};
            rig_settings s = rig_default_settings();
            s.omega = 0.75; /* weights 4 and 3 */
            s.k = 63;
            s.q = (float)q;
            uint8_t *volume = rig_map_volume(ends, ends + side * side, side, side, depths[n]);
            compare_summary all = {0};
            in_all_layouts(*state, f, volume, s, "largest sums", &all);
            assert_true(all.worst <= depths[n] * 0x1p-22); /* a constant stays one, but for float32 */
            free(volume);
            free(ends);
        }
}

/* The format: 16 bits hold weight * depth, and one bit more would not. */
static void test_format(void **state) {
    for (uint32_t slices = 1; slices <= 8192; slices++)
        for (uint32_t weight = 1; weight <= 4; weight++) {
            const sv_fixed format = sv_half_format(slices, weight);
            const uint64_t largest = (uint64_t)(slices > 1 ? slices - 1 : 1) * weight << format.fraction;
            assert_true(largest <= UINT16_MAX);
            assert_true(format.fraction >= 1);
            assert_true(2 * largest > UINT16_MAX || format.fraction == 16);
            assert_true(63 * 63 * largest <= UINT32_MAX); /* the largest window */
        }
}

/* What the tables quote: the error on scattered points and on patches. */
static void test_error(void **state) {
    for (int set = 0; set < 2; set++)
        for (uint32_t k = 3; k <= 23; k += 20) {
            surface_points p = set == 0 ? surface_scattered(171, 171, 60, 171 * 171 / 33, 71)
                                        : surface_patches(171, 171, 60, 7);
            const surface_chain chain = {.method = SV_METHOD_MEAN, .k = k, .half = true, .q = 0.5f};
            rig_result out = rig_result_make(p.width, p.height);
            assert_int_equal(surface_run(*state, &p, &chain, &out, NULL), SV_OK);
            double *expected = surface_expect(&p, &chain);
            const double error = surface_error(&out, expected, (size_t)p.width * p.height);
            const double bound = out.points.passes * (ldexp(0.5, -9) + 60 * 0x1p-23) + 60 * 0x1p-22;
            print_message(
                "int16, k = %-2u %-9s 171 x 171, 60 slices: error %.1e slices, bound %.1e, %u passes\n", k,
                set ? "patches" : "scattered", error, bound, out.points.passes);
            assert_int_equal(sv_half_format(60, 2).fraction, 9);
            assert_true(error <= bound);
            free(expected);
            rig_result_free(&out);
            surface_points_free(&p);
        }
}

UNIT_MAIN(NULL, NULL, RIG_TEST(test_volumes), RIG_TEST(test_largest), cmocka_unit_test(test_format),
          RIG_TEST(test_error))
