/* SPDX-License-Identifier: MIT */
/*
 * The surface told by the wall, with answers worked out by hand from the numbers of docs/surface.md: kernels
 * and definition read the same constants, so comparing them says nothing about those.
 */
#include "support/wall_fixture.h"

/* Every ray: wall, fluid, tissue that passes for the fetus with probability p, fluid, the fetus. The surface
 * lies in the first fluid; the ray pays 8 (1 - p) there for what it leaves, and 5 halves the confidence. */
static void test_confidence_of_a_doubtful_ray(void **state) {
    (void)state;
    enum {
        DIM = 90,
        BRIGHTER = 95,
        SPREAD_FIFTH = 5
    }; /* the wall is even, so its spread is the least, 0.2 */
    scan s = scan_make(N, N, N);
    for (uint32_t z = 0; z < N; z++) {
        const int level = z < 12 ? DIM : z >= 24 && z < 34 ? BRIGHTER : z >= 46 ? BONE : FLUID;
        for (uint32_t i = 0; i < PIXELS; i++) s.voxels[z * PIXELS + i] = (uint8_t)level;
    }
    scan_run(&s);
    const double brighter = (log(BRIGHTER / (255.5 - BRIGHTER)) - log(DIM / (255.5 - DIM))) * SPREAD_FIFTH;
    const double p = 1.0 / (1.0 + exp(-5.0 * (brighter - 0.4)));
    const double expected = 1.0 / (1.0 + square(8.0 * (1.0 - p) / 5.0));
    assert_true(p > 0.45 && p < 0.6);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    for (uint32_t i = 0; i < PIXELS; i++) {
        assert_true(s.depth[i] > 11.0f && s.depth[i] < 24.0f);
        /* p is looked up for whole levels of odds, and costs are integers of 1/128. */
        assert_true(fabs(s.confidence[i] - expected) < 0.01);
    }
    scan_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_confidence_of_a_doubtful_ray)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
