/* SPDX-License-Identifier: MIT */
/*
 * What the surface told by the wall (docs/surface.md) takes for fluid, as scalar C: levels without a valley
 * that are two classes all the same.
 */
#include "support/wall_fixture.h"

#include <stdio.h>

/* Tissue that fades from one side to the other has no mode of its own, and only half of the rays begin at a
 * wall. But fluid and tissue lie too far apart to be one class. */
static void test_fading_tissue(void **state) {
    (void)state;
    scan s = scene();
    for (uint32_t z = 0; z < N; z++)
        for (uint32_t y = 0; y < N; y++)
            for (uint32_t x = 0; x < N; x++) {
                uint8_t *const voxel = &s.voxels[at(&s, x, y, z)];
                if (z < WALL && x >= N / 2) *voxel = (uint8_t)(FLUID * grain(x, y, z));
                if (*voxel > 2 * FLUID) *voxel = (uint8_t)(10.0 + *voxel * square((double)y / N));
            }
    scan_run(&s);
    printf("fading: valley %.2f, %.2f of the variance between the classes\n", s.facts.valley, s.facts.parted);
    assert_true(s.facts.valley > 0.9 && s.facts.parted > 0.8);
    assert_true(s.facts.wall_rays < s.facts.rays * 3 / 4);
    assert_int_equal(s.outcome, SV_WALL_SURFACE);
    scan_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fading_tissue)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
