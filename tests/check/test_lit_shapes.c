/* SPDX-License-Identifier: MIT */
/*
 * The lit look has no rings, and its brightness does not depend on the volume's resolution: bodies without
 * noise against their analytic shading, at 64^3 to 256^3. `test_lit_shapes 512` adds 512^3 (`make bench` runs
 * it), and prints the table either way.
 */
#include "support/lit_shapes.h"

#define LIMIT 0.02

static uint32_t largest = 256;

static void shading_is_the_analytic_one(void **state) {
    for (int i = 0; i < LIT_SHAPES; i++) {
        double before = 0.0;
        /* A hard edge is a staircase, and at 64^3 its steps are as wide as the smoothing. */
        const uint32_t smallest = lit_shapes[i].edge > 0.0 ? 64 : 128;
        for (uint32_t size = smallest; size <= largest; size *= 2) {
            const lit_difference d = lit_shape_measure(*state, &lit_shapes[i], size);
            print_message("%-26s %4u^3: RMS %5.2f %%, mean %.4f", lit_shapes[i].name, size, 100 * d.rms,
                          d.mean);
            if (before > 0.0) print_message(" (%+.2f %%)", 100 * (d.mean / before - 1.0));
            print_message("\n");
            if (d.rms > LIMIT) fail_msg("%s at %u^3: off by %g", lit_shapes[i].name, size, d.rms);
            if (before > 0.0 && (d.mean > before * (1 + LIMIT) || d.mean < before * (1 - LIMIT)))
                fail_msg("%s at %u^3: mean %g, at half the size %g", lit_shapes[i].name, size, d.mean,
                         before);
            before = d.mean;
        }
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(shading_is_the_analytic_one)};
    if (argc > 1) largest = (uint32_t)strtoul(argv[1], NULL, 10);
    return cmocka_run_group_tests(tests, test_open_device, test_close_device);
}
