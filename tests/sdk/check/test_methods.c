/* SPDX-License-Identifier: MIT */
/* Every reconstruction method against its float64 definition, and the knob. Behind the pre-filter, at depths
 * near 8,150 and with other settings: test_method_hard.
 * Requirement: R2. */
#include "support/surfaces.h"

static uint32_t held[SV_METHOD_END]; /* chains of a method that were held to its definition */

/* Runs a chain and holds it to its definition; prints what docs/numerics.md quotes. */
static void check(rig *r, const surface_points *points, const surface_chain *chain, double bound,
                  const char *what) {
    rig_result out;
    const double error = surface_try(r, points, chain, NULL, &out);
    surface_check_points(&out, points, chain->method);
    print_message("%-9s %-34s %4u x %-4u error %.2e slices, bound %.0e\n", surface_name(chain->method), what,
                  points->width, points->height, error, bound);
    assert_true(error <= bound);
    assert_int_equal(out.stats.unfilled, 0);
    held[chain->method]++;
}

/* q > 1: depths below 0 must come through. */
static void test_definition(void **state) {
    static const uint32_t sizes[][2] = {{75, 40}, {16, 64}, {33, 31}};
    for (int method = surface_next_of_points(-1); method >= 0; method = surface_next_of_points(method))
        for (uint32_t n = 0; n < 3; n++) {
            const uint32_t pixels = sizes[n][0] * sizes[n][1];
            surface_points p = surface_scattered(sizes[n][0], sizes[n][1], 60, pixels / 20, 5 + n);
            const surface_chain chain = {.method = method, .q = n == 2 ? 1.5f : 0.25f, .k = 11};
            check(*state, &p, &chain, surface_bound(&chain, &p), "5 % of the pixels");
        }
}

/* Methods that take the volume: layers of skin, fluid and fetus, in every layout of the work. */
static void test_volumes(void **state) {
    surface_points p = surface_points_make(70, 45, 60);
    for (uint32_t y = 0; y < p.height; y++)
        for (uint32_t x = 0; x < p.width; x++)
            if (x % 9 > 0) surface_put(&p, x, y, 9 + x / 12, 30 + (x / 8 + y / 6) % 6);
    for (int method = surface_next(-1); method >= 0; method = surface_next(method))
        for (uint32_t strategy = 1; strategy <= 3; strategy++) {
            const surface_chain chain = {.method = method, .q = 0.75f, .k = 11, .strategy = strategy};
            check(*state, &p, &chain, surface_bound(&chain, &p), "layers");
        }
}

/* What bones give: patches with wide gaps. */
static void test_patches(void **state) {
    static const uint32_t sides[] = {128, 171};
    for (int n = 0; n < 2; n++) {
        surface_points p = surface_patches(sides[n], sides[n], 60, 7);
        for (int method = surface_next_of_points(-1); method >= 0; method = surface_next_of_points(method)) {
            const surface_chain chain = {
                .method = method, .q = 0.25f, .k = 11, .merge_grid = method == SV_METHOD_SPLINE ? 16 : 0};
            check(*state, &p, &chain, surface_bound(&chain, &p), "patches");
        }
    }
}

/* One frame with q = 0.25, then adjust to 1.5, and back and forth: the same map as a frame with q = 1.5. */
static void check_adjust(rig *r, const surface_points *points, int method, bool prefilter,
                         uint32_t strategy) {
    const surface_chain chain = {.method = method, .prefilter_passes = prefilter, .strategy = strategy};
    const rig_format format = surface_format(r, points, &chain);
    const stage *t = rig_stage(r, &format, surface_volume(points));
    rig_result first = rig_result_make(points->width, points->height);
    rig_result second = rig_result_make(points->width, points->height);
    const sv_param_value low[] = {{rig_param(r, "q"), 0, 0.25}, {rig_param(r, "evidence"), 0, 0.0}};
    const sv_param_value high[] = {{rig_param(r, "q"), 0, 1.5}, {rig_param(r, "evidence"), 0, 0.0}};
    const sv_result result = {.size = sizeof result, .depth = first.depth, .stats = &first.stats};
    assert_int_equal(r->plugin->activate(r->plugin, &t->format), SV_OK);
    assert_int_equal(rig_frame(r, t, low, 2, &first), SV_OK);
    for (int turn = 0; turn < 3; turn++)
        assert_int_equal(r->plugin->adjust(r->plugin, turn == 1 ? low : high, 1, &result), SV_OK);
    assert_int_equal(clFinish(r->queue), CL_SUCCESS);
    assert_int_equal(rig_frame(r, t, high, 2, &second), SV_OK);
    assert_memory_equal(first.depth, second.depth, (size_t)points->width * points->height * sizeof(float));
    assert_int_equal(first.points.passes, second.points.passes);
    r->plugin->deactivate(r->plugin);
}

static void test_adjust(void **state) {
    surface_points p = surface_scattered(40, 33, 60, 70, 3);
    for (int method = surface_next_of_points(-1); method >= 0; method = surface_next_of_points(method))
        for (uint32_t n = 0; n < 6; n++) check_adjust(*state, &p, method, n % 2, 1 + n / 2);
}

/* Comes last: no method of the list went through the tests above without being held to its definition. */
static void test_nothing_is_left(void **state) {
    uint32_t methods = 0;
#define IS_HELD(NAME, value, key)                                                                            \
    if (held[value] == 0) fail_msg("method %s was held to nothing", #key);                                   \
    methods++;
    SV_METHODS(IS_HELD)
#undef IS_HELD
    assert_true(methods > 0);
}

UNIT_MAIN(rig_setup, rig_teardown, test_definition, test_volumes, test_patches, test_adjust,
          test_nothing_is_left)
