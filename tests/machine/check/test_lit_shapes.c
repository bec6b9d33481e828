/* SPDX-License-Identifier: MIT */
/*
 * The lit look has no rings, and its brightness does not depend on the volume's resolution: bodies without
 * noise against their analytic shading, at 64^3 to 256^3. `test_lit_shapes 512` adds 512^3 (`make bench` runs
 * it), and prints the table either way.
 */
#include "support/lit_shapes.h"

#define LIMIT  0.02
#define ANGLES 16

static uint32_t largest = 256;

/* Whether the shading is the analytic one at `size`, and as bright as at half of it (`before`; 0: not known).
 * Returns the mean brightness. */
static double hold(const hs_cl *cl, const lit_shape *shape, uint32_t size, double before) {
    const lit_difference d = lit_shape_measure(cl, shape, size);
    print_message("%-26s %4u^3: RMS %5.2f %%, mean %.4f", shape->name, size, 100 * d.rms, d.mean);
    if (before > 0.0) print_message(" (%+.2f %%)", 100 * (d.mean / before - 1.0));
    print_message("\n");
    if (d.rms > LIMIT) fail_msg("%s at %u^3: off by %g", shape->name, size, d.rms);
    if (before > 0.0 && (d.mean > before * (1 + LIMIT) || d.mean < before * (1 - LIMIT)))
        fail_msg("%s at %u^3: mean %g, at half the size %g", shape->name, size, d.mean, before);
    return d.mean;
}

static void shading_is_the_analytic_one(void **state) {
    for (int i = 0; i < LIT_SHAPES; i++) {
        const lit_shape *shape = &lit_shapes[i];
        double before = 0.0;
        /* In fluid a binary edge is a staircase that tissue does not have: docs/rendering.md. */
        const bool staircase = shape->edge <= LIT_BINARY && shape->edge >= LIT_BINARY && !shape->scan_face;
        for (uint32_t size = staircase ? 128 : 64; size <= largest; size *= 2)
            before = hold(*state, shape, size, before);
    }
}

/* Bodies of every kind from all sides, hard and soft, at the sizes where a voxel is largest. */
static void shading_is_the_analytic_one_at_any_angle(void **state) {
    static const double edges[3] = {LIT_COVERED, 1.0, 2.0};
    test_random random = {20};
    for (int i = 0; i < ANGLES; i++) {
        lit_shape s = {.plane = i % 2 == 0, .edge = edges[i % 3], .level = test_uniform(&random, 120, 255)};
        char name[48];
        for (int k = 0; k < 3; k++) s.radius[k] = test_uniform(&random, 26, 40);
        s.turn = test_uniform(&random, -50, 50);
        s.tilt = test_uniform(&random, -30, 30);
        s.yaw = s.plane ? 0.0 : test_uniform(&random, -90, 90);
        s.pitch = s.plane ? 0.0 : test_uniform(&random, -60, 60);
        (void)snprintf(name, sizeof name, "%s %d, %+3.0f, %+3.0f", s.plane ? "plane" : "ellipsoid", i, s.turn,
                       s.plane ? s.tilt : s.yaw);
        s.name = name;
        (void)hold(*state, &s, 128, hold(*state, &s, 64, 0.0));
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(shading_is_the_analytic_one),
                                       cmocka_unit_test(shading_is_the_analytic_one_at_any_angle)};
    if (argc > 1) largest = (uint32_t)strtoul(argv[1], NULL, 10);
    return cmocka_run_group_tests(tests, test_open_device, test_close_device);
}
