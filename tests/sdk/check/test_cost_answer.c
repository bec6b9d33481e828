/* SPDX-License-Identifier: MIT */
/*
 * What a ray pays for its labels, by the numbers of docs/cost_volume.md written out here: kernels and
 * definition read the same constants, so that comparing them says nothing about those.
 */
#include "ref/ref_cost.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 64, SLICES = 128, PLANE = SIDE * SIDE };
/* Slices at which they begin: the sac's fluid, the fetus, the fluid behind it, the back of the sac. */
enum { FLUID = 10, FETUS = 40, BEHIND = 70, BACK = 90 };
enum { GREY_WALL = 150, GREY_FLUID = 10, GREY_FETUS = 255, GREY_BACK = 120 };

/* Fills the volume: all rays are alike, with one voxel a bin. */
static void fill(uint8_t *volume) {
    for (int z = 0; z < SLICES; z++) {
        const int grey = z < FLUID                  ? GREY_WALL
                         : z >= FETUS && z < BEHIND ? GREY_FETUS
                         : z >= BACK                ? GREY_BACK
                                                    : GREY_FLUID;
        memset(volume + (size_t)z * PLANE, grey, PLANE);
    }
}

static double logistic(double x) {
    return 1.0 / (1.0 + exp(-x));
}

static void test_one_ray(void **state) {
    (void)state;
    static uint8_t volume[PLANE * SLICES], bins[PLANE * SLICES], wall[PLANE], back[PLANE];
    static uint16_t sums[PLANE * SLICES], nearby[PLANE * SLICES];
    fill(volume);
    const sv_ref_volume v = {
        .voxels = volume, .width = SIDE, .height = SIDE, .slices = SLICES, .padding = -1};
    const sv_ref_cost_layout l = sv_ref_cost_layout_of(SIDE, SIDE, SLICES, 0.0f);
    assert_int_equal(l.sizes.labels, SLICES); /* so lengths are as they are written */
    sv_ref_cost_bins(&v, &l, bins);
    const sv_ref_cost_scan scan = {.layout = &l,
                                   .bins = bins,
                                   .levels = sv_ref_cost_levels_of(bins, &l),
                                   .sums = sums,
                                   .nearby = nearby,
                                   .wall = wall,
                                   .back = back};
    assert_true(sv_ref_cost_brightness(bins, &l, sums, nearby));
    assert_true(sv_ref_cost_walls(bins, &l, scan.levels.fluid, wall, back));
    /* Means of the classes, and a sixth of the way from the dark one to the bright one. */
    const int bright = (FLUID * GREY_WALL + (BEHIND - FETUS) * GREY_FETUS + (SLICES - BACK) * GREY_BACK) /
                       (FLUID + BEHIND - FETUS + SLICES - BACK);
    assert_int_equal(scan.levels.bright, bright);
    assert_int_equal(scan.levels.fluid, GREY_FLUID + (bright - GREY_FLUID) / 6);

    sv_ref_cost_ray ray;
    assert_true(sv_ref_cost_of_ray(&scan, SIDE / 2, SIDE / 2, &ray));
    assert_true(ray.open && ray.weight == 1.0);
    /* Ten times the brightness nearby, four times the ray's own, two for a thick run, less nineteen. */
    const double relative = (double)GREY_FETUS / bright, fetus = logistic(14.0 * relative + 2.0 - 19.0);
    assert_true(fetus > 0.9 && relative < 1.5); /* a fetus without bone that splits it */
    const double nobody = 1.0 - fetus;
    assert_true(fabs(ray.cost[20]) < 1e-9); /* in the fluid */
    assert_true(fabs(ray.cost[FETUS] - (0.5 / 4.0 + 3.0 * fetus + 3.0 * nobody)) <
                1e-9);                                                           /* its front: half a bin */
    assert_true(fabs(ray.cost[50] - (1.0 + 3.0 * fetus + 3.0 * nobody)) < 1e-9); /* in the fetus */
    assert_true(fabs(ray.cost[80] - (3.0 * fetus + 3.0 * nobody)) < 1e-9);       /* in the fluid behind it */
    assert_true(fabs(ray.cost[2] - (1.0 + 2.0 * fetus + 3.0 * nobody)) < 1e-9);  /* in the wall */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one_ray)};
    return cmocka_run_group_tests_name("what a ray pays", tests, NULL, NULL);
}
